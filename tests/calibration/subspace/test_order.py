"""How many states there are: noise alone, weak modes, and what is preferred among those that stand out."""

import numpy as np
import pytest
from scipy.signal import lfilter

from calibration import subspace
from calibration.subspace.estimate import compress
from calibration.subspace.order import standing_out
from calibration.subspace.signals import signals
from calibration.subspace.windows import Layout, Windows
from tests.calibration.resonant_systems import RATE, order_7, order_18


def count(drive: np.ndarray, response: np.ndarray, horizon: int) -> int:
    """Count the states that stand out of a record."""
    data = signals([drive], [response], True)
    layout = Layout(horizon, horizon, drive.shape[1], response.shape[1])
    windows = Windows(data.joined, layout, 1, constant=True)
    return standing_out(compress(windows, "moesp").triangle, layout, windows.count())


@pytest.mark.parametrize("horizon", [10, 20, 40])
def test_nothing_stands_out_of_noise_alone(horizon: int) -> None:
    rng = np.random.default_rng(1)
    found = [count(rng.standard_normal((3000, 1)), rng.standard_normal((3000, 2)), horizon) for _ in range(20)]
    assert found == [0] * 20


def test_the_same_states_stand_out_at_every_horizon_and_length() -> None:
    system = order_18()
    for samples, horizon in ((4000, 15), (10_000, 20), (10_000, 40), (40_000, 30)):
        assert count(*system.record(samples, seed=2), horizon) == 18


@pytest.mark.sample(1)
@pytest.mark.parametrize("horizon", [20, 40])
def test_a_weak_state_behind_the_largest_gap_is_found_all_the_same(horizon: int) -> None:
    """A pole at 60 Hz that moves the output less than the noise does."""
    drive, response = order_7().record(10_000, seed=3)
    pole = np.exp(-2 * np.pi * 60.0 / RATE)
    weak = lfilter([0.0, 1.0], [1.0, -pole], drive, axis=0)
    found = subspace.identify(drive, response + 0.08 * weak / weak.std(), RATE, horizon=horizon)
    values = found.singular_values
    assert int(np.argmax(values[:12] / values[1:13])) + 1 == 7
    assert found.model.order == 8
