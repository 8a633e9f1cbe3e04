"""Sum, gain, saturation, delay and hold against what they say, sample by sample."""

import numpy as np
import pytest

from ctlblocks import Block
from ctlblocks.basic import Gain, RateHold, Saturation, Sum, UnitDelay

NOISE = np.random.default_rng(1).standard_normal((60, 2))


def run(block: Block, *signals: np.ndarray, frames: int = 60) -> np.ndarray:
    """Run signals, shape (60, width), through a block `frames` at a time."""
    block.prepare(1000.0, frames)
    result = np.full((len(signals[0]), block.outputs[0].width), np.nan)
    for start in range(0, len(result), frames):
        block.process(*(signal[start : start + frames] for signal in signals), result[start : start + frames])
    return result


def test_a_sum_adds_or_subtracts() -> None:
    other = NOISE[::-1]
    assert np.array_equal(run(Sum("++", width=2), NOISE, other), NOISE + other)
    assert np.array_equal(run(Sum("+-", width=2), NOISE, other), NOISE - other)


def test_a_sum_with_other_signs_is_refused() -> None:
    with pytest.raises(ValueError, match=r"signs is '-\+', must be '\+\+' or '\+-'"):
        Sum("-+")


def test_a_gain_multiplies_and_takes_another_factor() -> None:
    gain = Gain(-2.5, "V", "m/s^2", width=2)
    assert (gain.inputs[0].unit, gain.outputs[0].unit) == ("V", "m/s^2")
    assert np.array_equal(run(gain, NOISE), -2.5 * NOISE)
    gain.change(0.1)
    assert np.array_equal(run(gain, NOISE), 0.1 * NOISE)


def test_a_gain_that_is_not_finite_is_refused_and_the_old_one_stays() -> None:
    with pytest.raises(ValueError, match="factor is nan, must be finite"):
        Gain(float("nan"))
    gain = Gain(2.0, width=2)
    with pytest.raises(ValueError, match="factor is inf, must be finite"):
        gain.change(float("inf"))
    assert np.array_equal(run(gain, NOISE), 2.0 * NOISE)


def test_a_saturation_limits_and_passes_what_is_within() -> None:
    limited = run(Saturation(-0.5, 1.0, width=2), NOISE)
    assert np.array_equal(limited, np.clip(NOISE, -0.5, 1.0))
    assert (limited == -0.5).any()
    assert (limited == NOISE).any()


def test_a_saturation_limits_infinity() -> None:
    signal = np.array([[np.inf], [-np.inf]])
    assert run(Saturation(-3.0, 2.0), signal, frames=2).tolist() == [[2.0], [-3.0]]


def test_a_nan_stops_a_saturation_which_says_where_and_lets_nothing_out() -> None:
    signal, limited = NOISE.copy(), np.ones((60, 2))
    signal[17, 1] = signal[30, 0] = np.nan
    block = Saturation(-1.0, 1.0, width=2)
    block.prepare(1000.0, 60)
    with pytest.raises(ValueError, match="signal is NaN in channel 1, sample 17 of the frame"):
        block.process(signal, limited)
    assert not limited.any()


@pytest.mark.parametrize(("low", "high"), [(1.0, 1.0), (2.0, 1.0), (-np.inf, 1.0), (0.0, np.inf), (np.nan, 1.0)])
def test_limits_that_do_not_rise_or_end_are_refused(low: float, high: float) -> None:
    with pytest.raises(ValueError, match=f"limits are {low} to {high} V, must be finite and rise"):
        Saturation(low, high, "V")


@pytest.mark.parametrize("frames", [1, 5, 60])
def test_a_unit_delay_is_one_sample_late_whatever_the_frames(frames: int) -> None:
    delayed = run(UnitDelay(width=2), NOISE, frames=frames)
    assert np.array_equal(delayed, np.vstack([np.zeros((1, 2)), NOISE[:-1]]))


@pytest.mark.parametrize("frames", [1, 2, 3, 4, 5, 12, 60])
@pytest.mark.parametrize("every", [1, 2, 3, 7, 20, 100])
def test_a_rate_hold_keeps_each_nth_sample_whatever_the_frames(every: int, frames: int) -> None:
    held = run(RateHold(every, width=2), NOISE, frames=frames)
    assert np.array_equal(held, NOISE[np.arange(60) // every * every])


def test_a_rate_hold_of_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="every is 0 samples, must be >= 1"):
        RateHold(0)
