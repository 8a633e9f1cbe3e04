"""The blocks every rig needs: sum, gain, saturation, delay and hold."""

import math

import numpy as np

from ctlblocks.block import Block, Port


class Sum(Block):
    """Add two signals, or subtract the second from the first: `first`, `second` in, `total` out.

    Parameters
    ----------
    signs : str, "++" or "+-"
    unit, width : str and int, what flows, and in how many channels
    """

    def __init__(self, signs: str = "++", unit: str = "1", width: int = 1) -> None:
        if signs not in ("++", "+-"):
            raise ValueError(f"signs is {signs!r}, must be '++' or '+-'")
        self.inputs = (Port("first", unit, width), Port("second", unit, width))
        self.outputs = (Port("total", unit, width),)
        self._operation = np.add if signs == "++" else np.subtract

    def process(self, first: np.ndarray, second: np.ndarray, total: np.ndarray) -> None:
        """Add one frame."""
        self._operation(first, second, total)


class Gain(Block):
    """Multiply by a number: `signal` in, `scaled` out.

    Parameters
    ----------
    factor : float, `scaled_unit` per `unit`, finite
    unit, scaled_unit : str
    width : int, channels, >= 1
    """

    def __init__(self, factor: float, unit: str = "1", scaled_unit: str = "1", width: int = 1) -> None:
        self.inputs = (Port("signal", unit, width),)
        self.outputs = (Port("scaled", scaled_unit, width),)
        self._factor = np.empty(())  # numpy would make an array of a Python float at every call
        self.change(factor)

    def process(self, signal: np.ndarray, scaled: np.ndarray) -> None:
        """Scale one frame."""
        np.multiply(signal, self._factor, scaled)

    def change(self, factor: float) -> None:
        """Take another factor (between ticks); one that is not finite is a ValueError."""
        if not math.isfinite(factor):
            raise ValueError(f"factor is {factor}, must be finite")
        self._factor.fill(factor)


class Saturation(Block):
    """Limit to low ... high: `signal` in, `limited` out.  NaN is not limited: it is a fault that stops the clock.

    Parameters
    ----------
    low, high : float, `unit`, finite, low < high
    unit, width : str and int, what flows, and in how many channels
    """

    def __init__(self, low: float, high: float, unit: str = "1", width: int = 1) -> None:
        if not -math.inf < low < high < math.inf:
            raise ValueError(f"limits are {low} to {high} {unit}, must be finite and rise")
        self.inputs = (Port("signal", unit, width),)
        self.outputs = (Port("limited", unit, width),)
        self._low, self._high = np.array(float(low)), np.array(float(high))

    def process(self, signal: np.ndarray, limited: np.ndarray) -> None:
        """Limit one frame; on a NaN in it, `limited` is zero and a ValueError says where."""
        np.minimum(signal, self._high, out=limited)
        np.maximum(limited, self._low, out=limited)
        lowest = int(limited.argmin())  # a NaN is lower than any number here
        if math.isnan(limited.item(lowest)):
            sample, channel = divmod(lowest, limited.shape[1])
            limited.fill(0.0)
            raise ValueError(f"signal is NaN in channel {channel}, sample {sample} of the frame, must be a number")


class UnitDelay(Block):
    """Delay by one sample, zero at first: `signal` in, `delayed` out.

    Parameters
    ----------
    unit, width : str and int, what flows, and in how many channels
    """

    def __init__(self, unit: str = "1", width: int = 1) -> None:
        self.inputs = (Port("signal", unit, width),)
        self.outputs = (Port("delayed", unit, width),)

    def prepare(self, rate: float, frames: int) -> None:
        """Forget the last sample."""
        self._last = np.zeros(self.outputs[0].width)

    def process(self, signal: np.ndarray, delayed: np.ndarray) -> None:
        """Delay one frame."""
        delayed[0] = self._last
        delayed[1:] = signal[:-1]
        self._last[:] = signal[-1]


class RateHold(Block):
    """Take every n-th sample, from the first, and hold it till the next, unfiltered: `signal` in, `held` out.

    Parameters
    ----------
    every : int, samples, >= 1
    unit, width : str and int, what flows, and in how many channels
    """

    def __init__(self, every: int, unit: str = "1", width: int = 1) -> None:
        if every < 1:
            raise ValueError(f"every is {every} samples, must be >= 1")
        self.inputs = (Port("signal", unit, width),)
        self.outputs = (Port("held", unit, width),)
        self._every = every

    def prepare(self, rate: float, frames: int) -> None:
        """Take the next sample that comes."""
        self._wait, self._last = 0, np.zeros(self.outputs[0].width)

    def process(self, signal: np.ndarray, held: np.ndarray) -> None:
        """Hold one frame: the rest of the hold before, whole holds, and the beginning of the last."""
        frames, every = len(signal), self._every
        first = min(self._wait, frames)
        last = frames - (frames - first) % every
        held[:first] = self._last
        held[first:last].reshape(-1, every, held.shape[1])[:] = signal[first:last:every, np.newaxis]
        held[last:] = signal[last:][:1]
        self._last[:] = held[-1]
        self._wait = (self._wait - frames) % every
