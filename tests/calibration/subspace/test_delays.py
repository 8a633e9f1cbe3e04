"""Dead time: found where it is, left alone where it is not, and modelled by states that hold the inputs."""

import numpy as np
import pytest
from scipy.signal import lfilter

from calibration import subspace
from calibration.subspace.asked import delay_of
from calibration.subspace.delays import LEAST, advanced, delayed, delays
from tests.calibration.resonant_systems import RATE, ResonantSystem, order_7, order_18

LATE = (45, 0, 7)


def late_record(
    system: ResonantSystem, late: tuple[int, ...], samples: int, seed: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return a record of a system whose inputs come late."""
    drive, response = system.record(samples + max(late), seed)
    given = [drive[each : samples + each, channel] for channel, each in enumerate(late)]
    return np.stack(given, axis=1), response[:samples]


@pytest.mark.parametrize("seed", range(5))
def test_each_input_s_delay_is_found(seed: int) -> None:
    drive, response = late_record(order_18(), LATE, 4000, seed)
    found = delays([drive], [response])
    assert found is not None
    assert np.all(np.abs(np.array(found.of_inputs) - LATE) <= 2)
    assert np.all(found.certainty > 4)


@pytest.mark.parametrize("seed", range(10))
def test_nothing_is_found_where_nothing_is_late(seed: int) -> None:
    found = delays(*([each] for each in order_7().record(3000, seed)))
    assert found is not None
    assert found.of_inputs == (0,)


def test_an_input_that_nobody_hears_is_not_late() -> None:
    drive, response = order_7().record(3000, seed=1)
    other = np.random.default_rng(2).standard_normal((3000, 1))
    found = delays([np.concatenate([drive, other], axis=1)], [response])
    assert found is not None
    assert found.samples[0, 1] == -1
    assert found.of_inputs == (0, 0)


@pytest.mark.parametrize(("late", "samples"), [(101, 3000), (150, 4000), (640, 4000), (1500, 8000)])
def test_dead_time_of_hundreds_of_samples_is_found_beside_an_input_without(late: int, samples: int) -> None:
    drive, response = late_record(order_18(), (late, 0, 4), samples, seed=1)
    found = delays([drive], [response])
    assert found is not None
    assert abs(found.of_inputs[0] - late) <= 2
    assert found.reach >= late


def test_how_far_was_looked_is_told() -> None:
    noise = [np.random.default_rng(seed).standard_normal((3000, 1)) for seed in (1, 2)]
    found = delays(noise[:1], noise[1:])
    assert found is not None
    assert (found.samples[0, 0], found.reach > 1000) == (-1, True)
    heard = delays(*([each] for each in order_7().record(3000, seed=1)))
    assert heard is not None
    assert heard.reach == 100


def test_of_short_records_and_of_poor_inputs_nothing_is_said() -> None:
    drive, response = order_7().record(300, seed=1)
    assert delays([drive], [response]) is None
    sine = np.sin(0.3 * np.arange(3000.0))[:, None]
    assert delays([sine], [sine]) is None


def test_a_delayed_model_is_the_model_of_the_inputs_of_before() -> None:
    system = order_18().model
    model = delayed(system, LATE)
    assert model.order == system.order + sum(LATE)
    drive = np.random.default_rng(3).standard_normal((400, 3))
    (moved,), _ = advanced([drive], [drive], LATE)
    padded = np.zeros_like(drive)
    for channel, each in enumerate(LATE):
        padded[each:, channel] = drive[: len(drive) - each, channel]
    np.testing.assert_allclose(model.simulate(drive), system.simulate(padded), atol=1e-9)
    np.testing.assert_array_equal(moved, padded[max(LATE) :])
    assert delayed(system, (0, 0, 0)) is system


def test_a_system_that_hears_45_samples_late_is_identified_as_well_as_one_that_does_not() -> None:
    found = subspace.identify(*late_record(order_7(), (45,), 4000, seed=6), RATE)
    assert found.delays in ((45,), (46,))  # without a direct term, the first sample that hears of it is the next
    assert found.core.order == 7
    assert f"dead time, samples: u1 {found.delays[0]}" in found.summary()
    assert len(found.poles()) == len(order_7().model.modes.pole)
    fresh = found.compare(*late_record(order_7(), (45,), 4000, seed=7)).fit
    plain = (
        subspace.identify(*order_7().record(4000, seed=6), RATE, order=7).compare(*order_7().record(4000, seed=7)).fit
    )
    assert fresh.free_run.nrmse[0] > plain.free_run.nrmse[0] - 0.3
    assert fresh.one_step.nrmse[0] > plain.one_step.nrmse[0] - 0.3


def test_a_delay_that_is_given_is_taken_and_one_that_is_forbidden_is_not() -> None:
    record = late_record(order_7(), (LEAST + 2,), 2000, seed=8)
    assert subspace.identify(*record, RATE, order=7, horizon=20, delay=LEAST + 2).delays == (LEAST + 2,)
    assert subspace.identify(*record, RATE, order=7, horizon=20, delay=0).delays == (0,)
    assert delay_of(4, 3, 100) == (4, 4, 4)


@pytest.mark.parametrize("late", [80, 120])
def test_an_input_that_is_held_for_as_long_is_not_heard_too_early(late: int) -> None:
    """What comes beyond the lags that are looked at first leaks into the last of them."""
    random = np.random.default_rng(2)
    drive = np.repeat(random.standard_normal(120), 52)[:6000]
    heard = lfilter([0.1], [1, -0.9], np.concatenate([np.zeros(late), drive])[:6000])
    heard += 0.1 * np.std(heard) * lfilter([1], [1, -0.5], random.standard_normal(6000))
    found = delays([(drive / np.std(drive))[:, None]], [(heard / np.std(heard))[:, None]])
    assert found is not None
    assert found.samples.tolist() == [[late]]
