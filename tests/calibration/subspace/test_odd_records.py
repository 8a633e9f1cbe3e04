"""Records in which something is not as the theory has it give a stable model all the same."""

import warnings

import numpy as np
import pytest
from scipy.signal import lfilter

from calibration import subspace
from tests.calibration.resonant_systems import RATE, order_7


def odd_record(kind: str) -> tuple[np.ndarray, np.ndarray]:
    """Return 300 samples of two inputs and two outputs in which something is not as the theory has it."""
    rng = np.random.default_rng(20)
    drive = rng.standard_normal((300, 2))
    match kind:
        case "one sine a channel":
            drive = np.sin(np.outer(np.arange(300), [0.3, 0.8]))
        case "one step":
            drive = np.repeat((np.arange(300) > 100)[:, None] * 1.0, 2, axis=1)
        case "an input twice":
            drive[:, 1] = drive[:, 0]
    response = lfilter([0.0, 1.0], [1.0, -0.8], drive @ np.array([[1.0, 2.0], [0.5, -1.0]]), axis=0)
    match kind:
        case "an output twice":
            response[:, 1] = response[:, 0]
        case "an output that is the input":
            response = drive.copy()
        case "integrated":
            response = np.cumsum(response, axis=0)
        case "noise a hundred times as loud":
            response += 100 * rng.standard_normal(response.shape)
        case "rounded to whole numbers":
            response = np.round(response).astype(int)
    return drive, response


@pytest.mark.filterwarnings("ignore:.* samples are few", "ignore:inputs 1 and 2 are the same signal")
@pytest.mark.sample(8)
@pytest.mark.parametrize(
    "kind",
    [
        "one sine a channel",
        "one step",
        "an input twice",
        "an output twice",
        "an output that is the input",
        "integrated",
        "noise a hundred times as loud",
        "rounded to whole numbers",
    ],
)
@pytest.mark.parametrize("method", ["n4sid", "moesp"])
@pytest.mark.parametrize("order", [None, 3])
def test_an_odd_record_gives_a_stable_model_all_the_same(kind: str, method: subspace.Method, order: int | None) -> None:
    found = subspace.identify(*odd_record(kind), RATE, order=order, method=method)
    assert found.model.is_stable
    assert np.all(np.abs(np.linalg.eigvals(found.model.A - found.model.K @ found.model.C)) < 1)
    assert np.all(np.isfinite(found.fit.one_step.nrmse))
    assert not np.any(np.isnan(found.pole_errors.frequency))


def test_two_inputs_that_are_one_signal_are_named() -> None:
    with pytest.warns(UserWarning, match="inputs 1 and 2 are the same signal"):
        subspace.identify(*odd_record("an input twice"), RATE, order=3, horizon=10)


@pytest.mark.parametrize("detrend", ["record", "linear"])
def test_levels_and_drifts_of_each_record_are_taken_away(detrend: subspace.Detrend) -> None:
    first, second = order_7().record(3000, seed=1), order_7().record(2000, seed=2)
    plain = subspace.identify([first[0], second[0]], [first[1], second[1]], RATE, order=7, horizon=20)
    drift = np.linspace(0.0, 5.0 if detrend == "linear" else 0.0, 3000)[:, None]
    moved = [first[1] + 3.0 + drift, second[1] - 4.0]
    found = subspace.identify([first[0], second[0]], moved, RATE, order=7, horizon=20, detrend=detrend)
    np.testing.assert_allclose(found.model.modes.frequency, plain.model.modes.frequency, rtol=0.01)
    assert found.fit.free_run.nrmse[0] > plain.fit.free_run.nrmse[0] - 0.5
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        careless = subspace.identify([first[0], second[0]], moved, RATE, order=7, horizon=20)
    assert careless.fit.free_run.nrmse[0] < 80
