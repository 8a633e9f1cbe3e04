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
        self._bounds = np.zeros(4)
        self._memory = np.zeros((4, axes))
        self._state = np.zeros(8, np.int64)

    def prepare(self, rate: float, frames: int) -> None:
        """Begin the ramp from the lowest voltage to rest, and count samples from zero.  A latch survives."""
        limits, latched = self._limits, self.latched
        self._bounds[:] = *limits.voltage, limits.voltage_slew / rate, limits.rest_voltage
        self._memory.fill(limits.voltage[0])
        self._memory[[kernel.LIMITED, kernel.APART]] = 0.0
        self._state[[kernel.POSITION, kernel.COUNT, kernel.EASING]] = 0
        self._state[kernel.RAMP] = max(1, round(limits.ramp * rate))
        self._state[kernel.PHASE] = kernel.FADING if latched else kernel.RAMPING

    def process(self, request: np.ndarray, fault: np.ndarray, voltage: np.ndarray) -> None:
        """Let out, ramp or hold one frame."""
        kernel.run(request, fault, voltage, self._bounds, self._memory, self._state)

    def open(self) -> None:
        """Let requests out from the next sample on (between ticks); ValueError unless it is shut and at rest."""
        if self._state[kernel.PHASE] != kernel.SHUT:
            state = "latched" if self.latched else "open" if self.is_open else "on its way to rest"
            raise ValueError(f"the guard is {state}, must be shut and at rest to be opened")
        self._state[[kernel.PHASE, kernel.EASING]] = kernel.OPEN, 0

    def ease_open(self) -> None:
        """As `open`, but let what the first request is off the voltage go along a raised cosine of `limits.ramp`."""
        self.open()
        self._state[kernel.EASING] = 1

    def close(self) -> None:
        """Ramp to rest and stay there (between ticks)."""
        if self.is_open:
            self._memory[kernel.FROM] = self._memory[kernel.LAST]
            self._state[[kernel.PHASE, kernel.POSITION]] = kernel.RAMPING, 0

    def trip(self, reason: str) -> None:
        """Go to rest and latch, for a reason from outside (between ticks)."""
        if not self.latched:
            self._reason = reason
            kernel.trip(self._state, self._memory, kernel.OUTSIDE, 0)

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
        still = "goes to rest" if self._state[kernel.PHASE] == kernel.FADING else ""
        cause = to_clear("the guard", self.cause, by, still)
        self._state[kernel.PHASE] = kernel.SHUT
        return cause

    @property
    def latched(self) -> bool:
        """Whether a fault has shut the guard (from the first sample of the ramp)."""
        return bool(self._state[kernel.PHASE] >= kernel.FADING)

    @property
    def cause(self) -> str | None:
        """What latched it, or None."""
        if not self.latched:
            return None
        axis = int(self._state[kernel.AXIS]) + 1
        return _CAUSES[int(self._state[kernel.CAUSE])].format(axis=axis, reason=self._reason)

    @property
    def is_open(self) -> bool:
        """Whether requests are let out."""
        return bool(self._state[kernel.PHASE] == kernel.OPEN)

    @property
    def at_rest(self) -> bool:
        """Whether the voltages are at rest and stay there: shut, or latched, with no ramp on its way."""
        return bool(self._state[kernel.PHASE] in (kernel.SHUT, kernel.LATCHED))

    @property
    def voltage(self) -> np.ndarray:
        """The last voltages let out, shape (axes,), V: a copy."""
        now: np.ndarray = self._memory[kernel.LAST].copy()
        return now

    @property
    def limited(self) -> tuple[int, ...]:
        """In how many samples a request was limited since `prepare`, a number an axis."""
        return tuple(int(count) for count in self._memory[kernel.LIMITED])
