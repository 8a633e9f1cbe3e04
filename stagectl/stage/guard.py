"""The guard: the last block before the piezos, which keeps voltages within limits and goes to rest on a fault."""

import numpy as np

from ctlblocks.block import Block, Port
from rigkit.latch import to_clear
from stagectl.config import Limits
from stagectl.stage import guard_kernel as kernel

_CAUSES = {
    kernel.SENSOR: "a sensor is at fault",
    kernel.REQUEST: "the request of axis {axis} is not a number",
    kernel.OUTSIDE: "{reason}",
}


class VoltageGuard(Block):
    """Let requests out within range and rate of change; on a fault, ramp every axis to rest without any sensor.

    After `prepare` it ramps from the lowest voltage to rest and is shut: the output stays whatever is requested.
    `open` lets requests out.  A fault (`fault` not 0, a request that is no number, or `trip`) takes all axes together
    from where they are to `limits.rest` along a raised cosine of `limits.ramp`, and latches; a person clears it.

    Ports: `request` (V), one wide an axis, and `fault` in; `voltage` (V) out; no controller may be wired behind it.

    Parameters
    ----------
    limits : Limits
    axes : int, >= 1
    """

    def __init__(self, limits: Limits, axes: int) -> None:
        self.inputs = (Port("request", "V", axes), Port("fault"))
        self.outputs = (Port("voltage", "V", axes),)
        self._limits = limits
        self._reason = ""
        self._guard = np.zeros(1, kernel.GUARD)
        self._axes = np.zeros(axes, kernel.AXIS)

    def prepare(self, rate: float, frames: int) -> None:
        """Begin the ramp from the lowest voltage to rest, and count samples from zero.  A latch survives."""
        limits, guard = self._limits, self._guard
        guard["phase"] = kernel.FADING if self.latched else kernel.RAMPING
        guard["ramp"] = max(1, round(limits.ramp * rate))
        guard[["low", "high"]] = limits.voltage
        guard["step"], guard["rest"] = limits.voltage_slew / rate, limits.rest_voltage
        guard["position"] = guard["count"] = guard["easing"] = 0
        self._axes[:] = limits.voltage[0], limits.voltage[0], 0.0, 0

    def process(self, request: np.ndarray, fault: np.ndarray, voltage: np.ndarray) -> None:
        """Let out, ramp or hold one frame."""
        kernel.run(request, fault, voltage, self._guard, self._axes)

    def open(self) -> None:
        """Let requests out from the next sample on (between ticks); ValueError unless it is shut and at rest."""
        if self._guard["phase"][0] != kernel.SHUT:
            state = "latched" if self.latched else "open" if self.is_open else "on its way to rest"
            raise ValueError(f"the guard is {state}, must be shut and at rest to be opened")
        self._guard["phase"], self._guard["easing"] = kernel.OPEN, 0

    def ease_open(self) -> None:
        """As `open`, but let what the first request is off the voltage go along a raised cosine of `limits.ramp`."""
        self.open()
        self._guard["easing"] = 1

    def close(self) -> None:
        """Ramp to rest and stay there (between ticks)."""
        if self.is_open:
            self._axes["begin"] = self._axes["last"]
            self._guard["phase"], self._guard["position"] = kernel.RAMPING, 0

    def trip(self, reason: str) -> None:
        """Go to rest and latch, for a reason from outside (between ticks)."""
        if not self.latched:
            self._reason = reason
            kernel.trip(self._guard[0], self._axes, kernel.OUTSIDE, 0)

    def clear(self, by: str) -> str:
        """Re-arm a latched guard, shut, in the name of the person who looked (between ticks).

        Parameters
        ----------
        by : str
            Who clears it; not empty.

        Returns
        -------
        str
            What is cleared.

        Raises
        ------
        ValueError : nobody is named, nothing is latched, or the ramp to rest is not over.
        """
        still = "goes to rest" if self._guard["phase"][0] == kernel.FADING else ""
        cause = to_clear("the guard", self.cause, by, still)
        self._guard["phase"] = kernel.SHUT
        return cause

    @property
    def latched(self) -> bool:
        """Whether a fault has shut the guard (from the first sample of the ramp)."""
        return bool(self._guard["phase"][0] >= kernel.FADING)

    @property
    def cause(self) -> str | None:
        """What latched it, or None."""
        if not self.latched:
            return None
        axis = int(self._guard["axis"][0]) + 1
        return _CAUSES[int(self._guard["cause"][0])].format(axis=axis, reason=self._reason)

    @property
    def is_open(self) -> bool:
        """Whether requests are let out."""
        return bool(self._guard["phase"][0] == kernel.OPEN)

    @property
    def at_rest(self) -> bool:
        """Whether the voltages are at rest and stay there: shut, or latched, with no ramp on its way."""
        return bool(self._guard["phase"][0] in (kernel.SHUT, kernel.LATCHED))

    @property
    def voltage(self) -> np.ndarray:
        """The last voltages let out, shape (axes,), V: a copy."""
        now: np.ndarray = self._axes["last"].copy()
        return now

    @property
    def limited(self) -> tuple[int, ...]:
        """In how many samples a request was limited since `prepare`, a number an axis."""
        return tuple(self._axes["limited"].tolist())
