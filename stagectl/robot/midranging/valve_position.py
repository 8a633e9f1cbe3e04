"""Valve position control: the fast manipulator takes the error, the slow one brings it back to mid-travel."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.robot.midranging import valve_position_kernel as kernel
from stagectl.robot.midranging.axis_record import VALVE
from stagectl.robot.midranging.tuning import Pi


@dataclass(frozen=True)
class ValvePositionAxis:
    """One axis of valve position control.

    Parameters
    ----------
    fast, slow : Pi
        C_f and C_s.  C_s a PI controller: modified valve position control (MVPC); one that only integrates: VPC.
    middle : float, m
        r^m, the middle of the fast manipulator's travel.
    tracking : float, s, > 0
        Anti-windup time of C_f; infinite for none.
    limit : float, m/s, > 0
        Where the fast loop's inner control signal saturates.
    inner_gain : float, 1/s, > 0
        Of the inner controller, from its error to its control signal.
    slow_time_constant : float, s, > 0
        Of the slow loop.
    feed : float, 0 to 1
        Share of what the slow loop is about to do that is taken off the fast reference.

    Raises
    ------
    ValueError : a value outside its range, by name.
    """

    fast: Pi
    slow: Pi
    middle: float = 0.0
    tracking: float = math.inf
    limit: float = math.inf
    inner_gain: float = 1.0
    slow_time_constant: float = 1.0
    feed: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what cannot be."""
        for name, unit in (("tracking", "s"), ("limit", "m/s"), ("inner_gain", "1/s"), ("slow_time_constant", "s")):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"{name} is {getattr(self, name)} {unit}, must be > 0")
        if not 0.0 <= self.feed <= 1.0:
            raise ValueError(f"feed is {self.feed}, must be 0 to 1")
        if not math.isfinite(self.middle):
            raise ValueError(f"middle is {self.middle} m, must be finite")

    def packed(self, rate: float) -> np.void:
        """Return the axis as the kernel reads it, its integrals empty, at `rate` samples/s."""
        record: np.void = np.zeros(1, VALVE)[0]
        record["fast_gain"], record["fast_rate"] = self.fast.gain, self.fast.rate / rate
        record["slow_gain"], record["slow_rate"] = self.slow.gain, self.slow.rate / rate
        record["tracking"], record["limit"] = 1.0 / (self.tracking * rate), self.limit
        record["inner_gain"], record["middle"], record["feed"] = self.inner_gain, self.middle, self.feed
        record["pole"] = math.exp(-1.0 / (self.slow_time_constant * rate))
        return record


class ValvePosition(Block):
    """VPC, MVPC, and MVPC with tracking anti-windup: r_f = C_f (r - y_r) + r^m, r_s = C_s (r_f - r^m), for every axis.

    Ports, one wide an axis: `reference`, `relative` (m, y_r = y_f + y_s + d) and `control` (m/s, the inner control
    signal of the sample before, ahead of its saturation) in; `fast_reference`, `slow_reference` (m) out.  While an
    input is no number, both references and both integrals stay.

    Parameters
    ----------
    axes : sequence of ValvePositionAxis

    Raises
    ------
    ValueError : there is no axis.

    Source
    ------
    Sörnmo 2015, figures 2.12 and 3.2; the integrals go on by forward Euler.
    """

    def __init__(self, axes: Sequence[ValvePositionAxis]) -> None:
        if not axes:
            raise ValueError("there are 0 axes, must be at least 1")
        width = len(axes)
        self.inputs = Port("reference", "m", width), Port("relative", "m", width), Port("control", "m/s", width)
        self.outputs = Port("fast_reference", "m", width), Port("slow_reference", "m", width)
        self._axes = tuple(axes)

    def prepare(self, rate: float, frames: int) -> None:
        """Empty the integrals."""
        self._records = np.array([axis.packed(rate) for axis in self._axes])

    def process(
        self,
        reference: np.ndarray,
        relative: np.ndarray,
        control: np.ndarray,
        fast_reference: np.ndarray,
        slow_reference: np.ndarray,
    ) -> None:
        """Control one frame."""
        kernel.run(reference, relative, control, fast_reference, slow_reference, self._records)

    @property
    def blind(self) -> tuple[int, ...]:
        """In how many samples an input was no number since `prepare`, a number an axis."""
        return tuple(int(count) for count in self._records["blind"])
