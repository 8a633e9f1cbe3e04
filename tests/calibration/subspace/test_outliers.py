"""Samples that are far off are found and replaced; what happened to the plant is not."""

import warnings

import numpy as np
import pytest
from scipy.signal import lfilter

from calibration import subspace
from calibration.state_space.model import InnovationModel
from calibration.subspace.outliers import without_outliers
from tests.calibration.resonant_systems import RATE, order_7, order_9

FREQUENCY = np.linspace(1.0, 480.0, 300)


def spiked(response: np.ndarray, share: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return a response with spikes of 5 to 50 of its standard deviations, and where they are."""
    rng = np.random.default_rng(seed)
    hit = rng.uniform(size=response.shape) < share
    sizes = rng.choice([-1.0, 1.0], response.shape) * rng.uniform(5, 50, response.shape) * response.std(axis=0)
    return response + hit * sizes, hit


def missed(model: InnovationModel, truth: InnovationModel) -> float:
    """Return what of a response is missed, re all of it."""
    difference = model.frequency_response(FREQUENCY) - truth.frequency_response(FREQUENCY)
    return float(np.linalg.norm(difference) / np.linalg.norm(truth.frequency_response(FREQUENCY)))


def test_spikes_cost_a_model_nothing() -> None:
    system = order_7()
    drive, response = system.record(5000, 5)
    with_spikes, hit = spiked(response, 1e-3, 3)
    with pytest.warns(UserWarning, match=f"{hit.sum()} of 5000 samples of output 1 are far off"):
        found = subspace.identify(drive, with_spikes, RATE, order=7, horizon=30)
    clean = subspace.identify(drive, response, RATE, order=7, horizon=30)
    kept = subspace.identify(drive, with_spikes, RATE, order=7, horizon=30, outliers="keep")
    np.testing.assert_array_equal(found.outliers[0], hit)
    assert missed(found.model, system.model) < 1.1 * missed(clean.model, system.model)
    assert missed(kept.model, system.model) > 2 * missed(clean.model, system.model)
    assert f"{hit.sum()} of 5000 samples of y1 are far off" in found.summary()
    assert found.fit.one_step.nrmse[0] > 90


@pytest.mark.parametrize("noise", [0.05, 1.0])
def test_one_sample_in_a_hundred_is_found_on_each_of_three_outputs(noise: float) -> None:
    drive, response = order_9().record(10_000, 5, noise=noise)
    with_spikes, hit = spiked(response, 0.01, 3)
    (clean,), (found,) = without_outliers([drive], [with_spikes])
    np.testing.assert_array_equal(found, hit)
    np.testing.assert_array_equal(clean[~hit], with_spikes[~hit])
    assert np.sqrt(np.mean((clean - response)[hit] ** 2)) < 0.2 * response.std()


def test_a_record_of_its_own_is_searched_by_what_all_tell() -> None:
    drives, responses = zip(*(order_7().record(2000, seed) for seed in (1, 2)), strict=True)
    marred, hit = spiked(responses[1], 0.002, 4)
    _, found = without_outliers(drives, [responses[0], marred])
    assert not found[0].any()
    np.testing.assert_array_equal(found[1], hit)


def test_a_knock_on_the_plant_is_no_outlier() -> None:
    rng = np.random.default_rng(1)
    drive, force = rng.standard_normal((4000, 1)), 0.1 * rng.standard_normal((4000, 1))
    force[1000::500] += 5.0
    response = lfilter([1.0], [1.0, -1.6, 0.9], drive + force, axis=0)
    _, (found,) = without_outliers([drive], [response])
    assert not found.any()


@pytest.mark.parametrize("kind", ["steps", "sweep", "sines", "held", "rounded"])
def test_nothing_is_found_where_nothing_is_wrong(kind: str) -> None:
    time = np.arange(4000)
    rng = np.random.default_rng(2)
    drive = {
        "steps": np.repeat(rng.standard_normal(40), 100),
        "sweep": np.sin(2e-5 * time**2),
        "sines": np.sin(np.outer(time, [0.1, 0.34, 1.2])).sum(axis=1),
        "held": rng.standard_normal(4000),
        "rounded": rng.choice([-1.0, 1.0], 4000),
    }[kind][:, None]
    response = lfilter([0, 0, 1.0], [1.0, -1.6, 0.9], drive, axis=0) + 0.02 * rng.standard_normal((4000, 1))
    if kind == "held":  # a logger that stood still, and went on where the plant was by then
        drive[2000:2050], response[2000:2050] = drive[1999], response[1999]
    if kind == "rounded":
        response = np.round(5 * response) / 5
    _, (found,) = without_outliers([drive], [response])
    assert not found.any()


def test_a_machine_that_becomes_loud_has_no_outliers() -> None:
    rng = np.random.default_rng(3)
    loud = np.geomspace(0.01, 1.0, 20_000)[:, None]
    drive = rng.standard_normal((20_000, 1))
    response = lfilter([0, 1.0], [1.0, -0.5], drive, axis=0) + loud * rng.standard_normal((20_000, 1))
    _, (found,) = without_outliers([drive], [response])
    assert not found.any()


def test_what_an_output_is_full_of_is_no_outlier() -> None:
    drive, response = order_7().record(5000, 6)
    _, (found,) = without_outliers([drive], [spiked(response, 0.06, 7)[0]])
    assert not found.any()


def test_in_short_records_nothing_is_looked_for() -> None:
    drive, response = order_7().record(150, 6)
    marred = spiked(response, 0.01, 7)[0]
    (clean,), (found,) = without_outliers([drive], [marred])
    np.testing.assert_array_equal(clean, marred)
    assert not found.any()


@pytest.mark.parametrize("samples", [1, 20, 30, 31])
def test_a_short_record_beside_a_long_one_is_no_trouble(samples: int) -> None:
    """Nothing foretells its first samples: there only what is far from all others is found."""
    drive, response = order_7().record(3000, 1)
    drives, responses = np.split(drive, [3000 - samples]), np.split(response, [3000 - samples])
    responses[1][-1] = 40.0 * response.std()
    _, found = without_outliers(drives, responses)
    assert not found[0].any()
    assert not found[1][:-1].any()


def test_another_word_is_refused() -> None:
    with pytest.raises(ValueError, match="outliers is 'drop', must be one of replace, keep"):
        subspace.identify(*order_7().record(500, 1), RATE, outliers="drop")  # type: ignore[arg-type]


def test_without_outliers_there_is_no_warning() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = subspace.identify(*order_7().record(3000, 1), RATE, order=7, horizon=30)
    assert not found.outliers[0].any()


def test_the_first_and_the_last_sample_can_be_outliers_too() -> None:
    u, y = order_7().record(2000, 3)
    y = y.copy()
    y[0] += 50.0 * y.std()
    y[-1] -= 50.0 * y.std()
    _, (found,) = without_outliers([u], [y])
    assert found[[0, -1], 0].all()
