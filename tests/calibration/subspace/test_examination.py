"""Records are looked at before there is a model: excitation, what is heard, loops, plants that are not linear."""

import numpy as np
import pytest
from scipy.signal import lfilter

from calibration import subspace
from tests.calibration.resonant_systems import order_7, order_18
from tests.calibration.subspace.test_feedback import record
from tests.calibration.subspace.test_time_series import series


def spring(samples: int, seed: int, cubic: float) -> tuple[np.ndarray, np.ndarray]:
    """Return drive and response, shapes (samples,), of a mass on a spring that hardens, with noise of 1 %."""
    rng = np.random.default_rng(seed)
    drive, response = rng.standard_normal(samples), np.zeros(samples)
    for n in range(2, samples):
        held = response[n - 1] + cubic * response[n - 1] ** 3
        response[n] = 1.9 * response[n - 1] - 0.95 * response[n - 2] - 0.1 * held + 0.05 * drive[n - 1]
    return drive, response + 0.01 * response.std() * rng.standard_normal(samples)


def test_records_in_order_are_called_so() -> None:
    said = subspace.examine(*order_7().record(3000, seed=1)).sentences
    assert said[:2] == ("3000 samples in 1 record", "inputs excite persistently of order 40 or more")
    assert said[2].startswith("input 1 shows in the outputs after so many samples: ")
    assert len(said) == 3


def test_what_is_not_heard_is_named() -> None:
    u, y = order_7().record(3000, seed=1)
    with_idle = np.column_stack([u, np.random.default_rng(2).standard_normal(3000)])
    said = str(subspace.examine(with_idle, y))
    assert "no output hears of input 2 within 1448 samples: what is identified of it is noise, or it comes" in said
    noise = np.random.default_rng(3).standard_normal((2, 2000))
    assert "no output hears of input 1" in str(subspace.examine(*noise))


def test_inputs_that_excite_too_little_or_twice_the_same_are_named() -> None:
    sine = np.sin(0.3 * np.arange(2000.0))[:, None]
    said = str(subspace.examine(*order_7().record(2000, seed=1, drive=sine)))
    assert "inputs excite persistently of order 2: enough for 1 states" in said
    assert "the response to the inputs cannot be determined" in said
    u, y = order_18().record(2000, seed=1)
    u[:, 2] = -u[:, 0]
    assert "inputs 1 and 3 are the same signal" in str(subspace.examine(u, y))


def test_a_loop_gaps_and_outliers_are_told_of() -> None:
    u, y = (each.copy() for each in record(8000, 1, 0.5, 1.0))
    y[5000] = np.nan
    y[3000] += 20 * y[:3000].std()
    with pytest.warns(UserWarning, match="1 of 8000 samples is missing"):
        found = subspace.examine(u, y)
    assert found.records == 2
    assert "input 1 follows from the outputs, which predict" in str(found)
    assert found.outliers[0][3000, 0]
    assert "replaced" in found.sentences[-1]


def test_a_time_series_has_nothing_to_hear() -> None:
    assert subspace.examine(None, series(3000, 1)).sentences == ("3000 samples in 1 record",)


@pytest.mark.parametrize("seed", range(5))
def test_a_spring_that_hardens_is_not_linear_and_one_that_does_not_is(seed: int) -> None:
    hard, soft = (subspace.examine(*spring(4000, seed, cubic)).nonlinearity for cubic in (0.3, 0.0))
    assert hard.outputs == (0,)
    assert "the plant is not linear there" in hard.sentences[0]
    assert soft.outputs == ()


def test_a_curved_amplifier_is_not_linear_and_foreign_noise_in_bursts_is_no_curve() -> None:
    rng = np.random.default_rng(6)
    u, y = order_7().record(6000, seed=2)
    _, curved = order_7().record(6000, seed=2, drive=u + 0.2 * u**2)
    assert subspace.examine(u, curved).nonlinearity.outputs == (0,)
    bursts = rng.standard_t(4, 6000) * (1 + np.sin(0.002 * np.arange(6000.0)))
    noisy = y + 0.3 * y.std() * lfilter([1.0], [1.0, -0.8], bursts)[:, None]
    assert subspace.examine(u, noisy).nonlinearity.outputs == ()


def test_a_model_of_a_plant_that_is_not_linear_says_so() -> None:
    found = subspace.identify(*spring(4000, 1, 0.3), 1.0, order=2, horizon=20)
    assert "the plant is not linear there" in found.summary()
