"""A whole trial through filters that are not causal: no phase, no jump at the ends."""

import numpy as np
import pytest
from scipy.signal import lfilter

from stagectl.robot.milling.zero_phase import filtered, low_pass

RATE = 250.0


def q(frequency: np.ndarray) -> np.ndarray:
    return low_pass(frequency, 10.0)[:, None, None] * np.eye(1)


def test_a_sine_below_the_cutoff_passes_without_phase() -> None:
    time = (np.arange(1000) + 0.5) / RATE
    sine = np.cos(2 * np.pi * 2.0 * time)[:, None]  # its mirror image goes on as it does
    assert filtered(sine, RATE, q) == pytest.approx(low_pass(np.array([2.0]), 10.0) * sine, abs=1e-9)


def test_a_sine_above_the_cutoff_is_gone() -> None:
    time = np.arange(2000) / RATE
    envelope = np.hanning(2000)
    passed = filtered((envelope * np.sin(2 * np.pi * 40.0 * time))[:, None], RATE, q)
    assert np.abs(passed).max() < 1e-3


def test_a_trial_that_rests_elsewhere_at_its_end_stays_there() -> None:
    step = np.concatenate([np.full(500, 1.0), np.linspace(1.0, 5.0, 300), np.full(500, 5.0)])[:, None]
    passed = filtered(step, RATE, q)
    assert passed[0, 0] == pytest.approx(1.0, abs=1e-6)
    assert passed[-1, 0] == pytest.approx(5.0, abs=1e-6)


def test_a_causal_filter_gives_what_it_gives_in_time_once_it_rests() -> None:
    ramp = np.concatenate([np.zeros(300), np.linspace(0.0, 2.0, 200), np.full(300, 2.0)])
    b, a = [0.2, 0.1], [1.0, -0.7]
    wanted = lfilter(b, a, ramp)

    def response(frequency: np.ndarray) -> np.ndarray:
        turn = np.exp(-2j * np.pi * frequency / RATE)
        return ((b[0] + b[1] * turn) / (1.0 + a[1] * turn))[:, None, None]

    assert np.abs(filtered(ramp[:, None], RATE, response)[:, 0] - wanted).max() < 1e-12


@pytest.mark.parametrize("length", [1, 2, 701, 1000])
def test_every_length_comes_back(length: int) -> None:
    signal = np.random.default_rng(1).standard_normal((length, 2))
    assert filtered(signal, RATE, lambda f: np.broadcast_to(np.eye(2), (len(f), 2, 2))) == pytest.approx(signal)


def test_a_trial_that_is_not_finite_is_refused_by_channel_and_sample() -> None:
    signal = np.zeros((10, 3))
    signal[4, 1] = np.nan
    with pytest.raises(ValueError, match="channel 2 of the trial is not finite at sample 4"):
        filtered(signal, RATE, q)
