"""The gain against what it says, sample by sample."""

import numpy as np
import pytest

from ctlblocks import Block
from ctlblocks.basic import Gain

NOISE = np.random.default_rng(1).standard_normal((60, 2))


def run(block: Block, *signals: np.ndarray, frames: int = 60) -> np.ndarray:
    """Run signals, shape (60, width), through a block `frames` at a time."""
    block.prepare(1000.0, frames)
    result = np.full((len(signals[0]), block.outputs[0].width), np.nan)
    for start in range(0, len(result), frames):
        block.process(*(signal[start : start + frames] for signal in signals), result[start : start + frames])
    return result


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
