"""Adaptive internal model control of a macro and a micro manipulator, with a governor before the micro one."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.robot.midranging import internal_model_kernel as kernel
from stagectl.robot.midranging.axis_record import (
    ACTIVE,
    AXIS,
    DIVERGING,
    ESTIMATING,
    INACCURATE,
    NO_REASON,
    OSCILLATING,
)
from stagectl.robot.midranging.estimation import Estimation
from stagectl.robot.midranging.internal_model_kernel import WINDOW
from stagectl.robot.midranging.least_squares import LeastSquares
from stagectl.robot.midranging.minimum_phase import minimum_phase
from stagectl.robot.midranging.reference_governor import Governor
from stagectl.robot.midranging.tuning import LoopModel, Pi
from stagectl.robot.midranging.valve_position import ValvePositionAxis

REASONS = {
    NO_REASON: "",
    INACCURATE: "no model is accurate enough after the estimation phase",
    DIVERGING: "a model is further off than what it explains",
    OSCILLATING: "the error oscillates, and nothing from outside makes it",
}
"""Why valve position control takes over."""
LONGEST = 1.0
"""s, of a dead time."""
NOISES = 4.0, 1.0
"""Standard deviations of the fast position's noise: how far the control signal keeps off its limit, and how far the
smoothed position may be from what is measured."""
SWING_LEAST = 0.05
"""Share of the travel, below which valve position control does not take over for an oscillation."""
RIPPLE_MEAN = 2.0
"""Memory of the mean that small oscillations are about, over the fast loop's dead time and time constant."""
FALL_BACK = ValvePositionAxis(Pi(1.0, 10.0), Pi(1.0, 1.0), tracking=0.1)


@dataclass(frozen=True)
class InternalModelAxis:
    """One axis of adaptive internal model control.

    Parameters
    ----------
    fast, slow : LoopModel
        First guesses of H_cl^f and H_cl^s; the higher of their orders is the order of all models.
    desired_fast, desired_slow : LoopModel
        T_f and T_s, with a gain of one at rest.
    governor : Governor
    fast_learning, slow_learning : LeastSquares
    middle : float, m
        Of the micro manipulator's travel.
    estimation : Estimation
    fast_delay, slow_delay : float, s, >= 0
        Dead times as they are known.
    valve : ValvePositionAxis
        What takes over where a model is not accurate enough or diverges.

    Raises
    ------
    ValueError : a dead time out of range, a desired response that has not the gain one, or an excitation that would
        saturate or leave the travel.
    """

    fast: LoopModel
    slow: LoopModel
    desired_fast: LoopModel
    desired_slow: LoopModel
    governor: Governor
    fast_learning: LeastSquares = field(default_factory=LeastSquares)
    slow_learning: LeastSquares = field(default_factory=LeastSquares)
    middle: float = 0.0
    estimation: Estimation = field(default_factory=Estimation)
    fast_delay: float = 0.0
    slow_delay: float = 0.0
    valve: ValvePositionAxis = FALL_BACK

    def __post_init__(self) -> None:
        """Refuse what cannot be."""
        for name in ("desired_fast", "desired_slow"):
            wanted: LoopModel = getattr(self, name)
            gain = sum(wanted.inputs) / (1.0 - sum(wanted.outputs))
            if not abs(gain - 1.0) < 1e-9:
                raise ValueError(
                    f"{name} has the gain {gain:g} at rest, must be 1: the fast manipulator would not return"
                )
        for name in ("fast_delay", "slow_delay"):
            if not 0.0 <= getattr(self, name) <= LONGEST:
                raise ValueError(f"{name} is {getattr(self, name)} s, must be 0 to {LONGEST}")
        if not math.isfinite(self.middle):
            raise ValueError(f"middle is {self.middle} m, must be finite")
        swing, most = 2.0 * self.estimation.fast_amplitude, self.governor.limit / self.governor.direct
        if not swing <= most:
            raise ValueError(
                f"fast_amplitude is {self.estimation.fast_amplitude} m, must be at most {0.5 * most:g} m: "
                "a step of twice that saturates the inner control signal"
            )
        if not swing <= self.governor.travel:
            raise ValueError(
                f"fast_amplitude is {self.estimation.fast_amplitude} m, must be at most half of the "
                f"{self.governor.travel} m to the end of the travel"
            )

    @property
    def order(self) -> int:
        """The order of the models."""
        return max(each.order for each in (self.fast, self.slow, self.desired_fast, self.desired_slow))


class InternalModel(Block):
    """Adaptive internal model control with recursive least squares and a reference governor, for every axis.

    Every axis begins in its estimation phase and goes over to control by itself.

    Ports, one wide an axis: `reference`, `relative`, `fast`, `slow` (m; y_r = y_f + y_s + d) in; `fast_reference`,
    `slow_reference` (m), `control` (m/s, the inner control signal this makes), `share` (alpha_k), `active` (1 once the
    estimation phase is over, 2 once valve position control has taken over, which it does for good) out, and
    `fast_model`, `slow_model`: the a and b in use of the first axis, the second ...

    Parameters
    ----------
    axes : sequence of InternalModelAxis
        All of one order.

    Raises
    ------
    ValueError : there is no axis, or they differ in order.

    Source
    ------
    Sörnmo 2015, eqs. (3.1) to (3.12).

    Departs
    -------
    Both models have dead times, found in the estimation phase; the fast loop is asked for T_f e less what the slow
    model will show by then.  A filter before either controller takes what the models do not explain, as slow as dead
    time and fit ask for.  The slow reference stays within the travel of where both are to be together.

    The governor takes the position of the same sample for its prediction, less a margin for its noise, so that the
    limit holds while the process changes; and it keeps the position within the travel as well.  An estimate without
    stable poles or with a gain far from one is not used; the last one that was goes on.  Where an input is no number,
    the models stand for the positions, half of the limit is used, and the last reference and disturbance go on.
    """

    def __init__(self, axes: Sequence[InternalModelAxis]) -> None:
        orders = {axis.order for axis in axes}
        if len(orders) != 1:
            raise ValueError(f"the axes have models of the orders {sorted(orders)}, must have one")
        width, (self.order,) = len(axes), orders
        self.inputs = tuple(Port(name, "m", width) for name in ("reference", "relative", "fast", "slow"))
        references = tuple(Port(name, "m", width) for name in ("fast_reference", "slow_reference"))
        models = tuple(Port(name, "1", 2 * self.order * width) for name in ("fast_model", "slow_model"))
        self.outputs = (*references, Port("control", "m/s", width), Port("share", "1", width),
                        Port("active", "1", width), *models)  # fmt: skip
        self._axes = tuple(axes)

    def prepare(self, rate: float, frames: int) -> None:
        """Begin the estimation phase, with the first guesses."""
        self._records = np.array([_packed(axis, self.order, rate) for axis in self._axes])

    def process(
        self,
        reference: np.ndarray,
        relative: np.ndarray,
        fast: np.ndarray,
        slow: np.ndarray,
        fast_reference: np.ndarray,
        slow_reference: np.ndarray,
        control: np.ndarray,
        share: np.ndarray,
        active: np.ndarray,
        fast_model: np.ndarray,
        slow_model: np.ndarray,
    ) -> None:
        """Control one frame."""
        made = fast_reference, slow_reference, control, share, active, fast_model, slow_model
        kernel.run(reference, relative, fast, slow, made, self._records)

    @property
    def blind(self) -> tuple[int, ...]:
        """In how many samples an input was no number since `prepare`, a number an axis."""
        return tuple(int(count) for count in self._records["blind"])

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why valve position control has taken over, a text an axis; empty where it has not."""
        return tuple(REASONS[int(reason)] for reason in self._records["reason"])


def _packed(axis: InternalModelAxis, order: int, rate: float) -> np.void:
    """Return an axis as the kernel reads it, at its beginning, with models of `order`."""
    phase = axis.estimation
    record: np.void = np.zeros(1, AXIS)[0]
    record["order"], record["middle"], record["governor"] = order, axis.middle, axis.governor.packed(rate)
    record["governor"]["margin"], record["governor"]["lean"] = (each * axis.fast_learning.noise for each in NOISES)
    most = max(phase.seconds, phase.half_periods * phase.slow_half_period)
    record["least_samples"], record["most_samples"] = round(phase.seconds * rate), round(most * rate)
    record["accuracy"], record["acceptable"] = phase.accuracy**2, phase.acceptable**2
    record["forget"] = math.exp(-1.0 / (2.0 * phase.slow_half_period * rate))
    record["phase"] = ACTIVE if phase.seconds == 0.0 else ESTIMATING
    record["valve"] = replace(axis.valve, tracking=math.inf, limit=math.inf).packed(rate)  # the governor limits
    record["tracking"] = 1.0 / (axis.valve.tracking * rate)
    for name in ("fast", "slow"):
        _pack_loop(record[name], axis, name, order, rate)
    window = WINDOW * sum(float(record["slow"][name]) for name in ("delay", "time"))
    record["fast"]["window_pole"] = record["slow"]["window_pole"] = math.exp(-1.0 / window)
    swing, noise = record["swing"], max(axis.fast_learning.noise, axis.slow_learning.noise)
    swing["pole"], swing["noise"] = math.exp(-WINDOW / window), noise
    travel = axis.governor.travel
    swing["least"] = max(SWING_LEAST * travel if math.isfinite(travel) else 0.0, NOISES[0] * noise)
    ripple, fast = record["ripple"], sum(float(record["fast"][name]) for name in ("delay", "time"))
    ripple["pole"], ripple["noise"], ripple["least"] = math.exp(-1.0 / (RIPPLE_MEAN * fast)), noise, NOISES[0] * noise
    return record


def _pack_loop(loop: np.void, axis: InternalModelAxis, name: str, order: int, rate: float) -> None:
    """Fill in the "fast" or the "slow" loop at its beginning."""
    learning, phase, told = getattr(axis, f"{name}_learning"), axis.estimation, getattr(axis, name)
    estimate, delay = told.of_order(order).parameters, getattr(axis, f"{name}_delay")
    time = told.time_constant(rate)
    loop["squares"] = learning.packed(estimate, rate)
    wanted: LoopModel = getattr(axis, f"desired_{name}")
    loop["wanted"]["used"][: 2 * order] = wanted.of_order(order).parameters
    pole = wanted.outputs[0] if wanted.order == 1 else 0.0
    loop["wanted_time"] = -1.0 / math.log(pole) if pole > 0.0 else 0.0
    loop["noise"], loop["amplitude"] = learning.noise**2, getattr(phase, f"{name}_amplitude")
    loop["half_period"] = getattr(phase, f"{name}_half_period") * rate
    loop["delay"], loop["time"] = round(delay * rate), time * rate
    if phase.seconds == 0.0:
        loop["filter_pole"] = math.exp(-1.0 / (delay * rate)) if delay else 0.0
    delays = phase.delays(delay, time, rate)
    loop["candidates"] = len(delays)
    whole = replace(learning, forgetting=1.0, alarm=False).packed(estimate, rate)
    for candidate, tried in zip(loop["bank"], delays, strict=False):  # a bank is seldom full
        candidate["squares"], candidate["delay"] = whole, tried
        candidate["model"]["used"][: 2 * order] = estimate
    loop["used"][: 2 * order], loop["mirrored"][:order] = estimate, minimum_phase(estimate[order:])
