"""The guard: the last block before the output, which lets out no drive that breaks a limit."""

import math
from dataclasses import dataclass

import numpy as np

from ctlblocks.block import Block, Port
from rigkit.latch import to_clear
from vibractl import guard_kernel as kernel
from vibractl.config import Limits

_LIMITS = ("finite", "peak", "slew", "rms")
_UNITS = ("V", "V", "V/s", "V")


@dataclass(frozen=True)
class Violation:
    """The first sample that broke a limit.

    Parameters
    ----------
    limit : str
        "finite", "peak", "slew" or "rms".
    channel : int, drive counted from 0
    sample : int, samples since `prepare` (of a whole drive: its row)
    value : float, V, or V/s for slew
    allowed : float, V, or V/s for slew; infinite for "finite"
    """

    limit: str
    channel: int
    sample: int
    value: float
    allowed: float

    def __str__(self) -> str:
        """Say it in one line."""
        unit = _UNITS[_LIMITS.index(self.limit)]
        bound = "must be finite" if self.limit == "finite" else f"limits.{self.limit} is {self.allowed:g} {unit}"
        return f"drive {self.channel + 1} asks for {self.value:g} {unit} at sample {self.sample}, {bound}"


class Guard(Block):
    """Let the request out while it keeps peak, slew and RMS limits; at the first sample that does not, fade and latch.

    It starts closed, which is an output of zero whatever is requested.  `open` and `close` move the gain along a
    raised cosine; fully open, the output is the request bit for bit.  What is checked is what would be let out, so
    a request is not looked at while the guard is closed.  The sample that breaks a limit never leaves: all drives go
    from their last value to zero along a raised cosine within `limits.ramp`, and stay there until a person clears it.

    The RMS limit holds for the root of an exponential mean of the squared output.  In the fade after a violation that
    mean may rise a little further, by less than `ramp / rms_seconds` of the squared peak.

    Ports: `request` (V) in, `output` (V) out; only a clock may read `output`.

    Parameters
    ----------
    limits : Limits
    width : int, drives, >= 1

    Raises
    ------
    ValueError : the ramp is so short that a fade from `peak` would itself break `slew`.
    """

    def __init__(self, limits: Limits, width: int) -> None:
        _refuse_short_ramp(limits)
        self.inputs = (Port("request", "V", width),)
        self.outputs = (Port("output", "V", width, last=True),)
        self.limits = limits
        self._latch = np.zeros(5)
        self._guard = np.zeros(1, kernel.GUARD)
        self._channels = np.zeros(width, kernel.CHANNEL)
        self._gains = np.zeros(2)

    def prepare(self, rate: float, frames: int) -> None:
        """Close, forget the RMS history and count samples from zero.  A latch survives: only `clear` ends it."""
        self._gains = kernel.set_up(self._guard, self.limits, rate)
        self._guard["phase"] = kernel.LATCHED if self.latched else kernel.WORKING
        self._guard["opening"] = self._guard["position"] = self._guard["count"] = 0
        self._channels[:] = 0.0

    def process(self, request: np.ndarray, output: np.ndarray) -> None:
        """Let out, ramp or fade one frame."""
        kernel.run(request, output, self._gains, self._guard, self._channels, self._latch)

    def open(self) -> None:
        """Start the ramp up (between ticks).  A latched guard stays shut."""
        self._guard["opening"] = True

    def close(self) -> None:
        """Start the ramp down (between ticks)."""
        self._guard["opening"] = False

    def clear(self, by: str) -> Violation:
        """Re-arm a latched guard, closed, in the name of the person who looked (between ticks).

        Parameters
        ----------
        by : str
            Who clears it; not empty.

        Returns
        -------
        Violation
            What is cleared.

        Raises
        ------
        ValueError : nobody is named, nothing is latched, or the fade is not over.
        """
        still = "fades to zero" if self._guard["phase"][0] == kernel.FADING else ""
        violation = to_clear("the guard", self.violation, by, still)
        self._guard["phase"], self._guard["opening"], self._guard["position"] = kernel.WORKING, False, 0
        return violation

    @property
    def latched(self) -> bool:
        """Whether a violation has shut the guard (from the first sample of the fade)."""
        return bool(self._guard["phase"][0] != kernel.WORKING)

    @property
    def violation(self) -> Violation | None:
        """What latched the guard, or None."""
        return as_violation(self._latch) if self.latched else None

    @property
    def latch(self) -> np.ndarray:
        """The violation as numbers, shape (5,): limit, channel, sample, value, allowed; see `as_violation`."""
        return self._latch

    @property
    def is_open(self) -> bool:
        """Whether the output is the request bit for bit."""
        up = self._guard["opening"][0] and self._guard["position"][0] == len(self._gains) - 1
        return not self.latched and bool(up)

    @property
    def is_closed(self) -> bool:
        """Whether the output is zero and stays so: closed and ramped down, or latched and faded."""
        if self._guard["phase"][0] == kernel.WORKING:
            return bool(not self._guard["opening"][0] and self._guard["position"][0] == 0)
        return bool(self._guard["phase"][0] == kernel.LATCHED)


def as_violation(latch: np.ndarray) -> Violation:
    """Read a guard's latch, shape (5,): limit number, channel, sample, value, allowed."""
    limit, channel, sample, value, allowed = latch.tolist()
    return Violation(_LIMITS[int(limit)], int(channel), int(sample), value, allowed)


def violation(drive: np.ndarray, limits: Limits, rate: float) -> Violation | None:
    """Check a whole drive against the limits, from rest to rest, with the guard's own kernel.

    Parameters
    ----------
    drive : array, shape (samples, width), V
    limits : Limits
    rate : float, samples/s

    Returns
    -------
    Violation or None
        The first sample at which a guard at rest would latch; sample `len(drive)` is the return to zero.

    Examples
    --------
    >>> print(violation(np.full((3, 1), 0.1), Limits(peak=0.05), 44_100.0))
    drive 1 asks for 0.1 V at sample 0, limits.peak is 0.05 V
    """
    guard, latch = np.zeros(1, kernel.GUARD), np.zeros(5)
    gains = kernel.set_up(guard, limits, rate)
    guard["opening"], guard["position"] = True, len(gains) - 1
    whole = np.zeros((len(drive) + 1, drive.shape[1]))
    whole[:-1] = drive
    kernel.run(whole, np.empty_like(whole), gains, guard, np.zeros(drive.shape[1], kernel.CHANNEL), latch)
    return None if guard["phase"][0] == kernel.WORKING else as_violation(latch)


def _refuse_short_ramp(limits: Limits) -> None:
    shortest = limits.peak * math.pi / 2 / limits.slew
    if limits.ramp < shortest:
        raise ValueError(
            f"limits.ramp is {limits.ramp:g} s, must be >= {shortest:.3g} s to fade from limits.peak "
            f"{limits.peak:g} V within limits.slew {limits.slew:g} V/s"
        )
