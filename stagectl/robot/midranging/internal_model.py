"""Adaptive internal model control of a macro and a micro manipulator, with a governor before the micro one."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.robot.midranging import internal_model_kernel as kernel
from stagectl.robot.midranging.axis_record import ACTIVE, AXIS, ESTIMATING
from stagectl.robot.midranging.least_squares import LeastSquares
from stagectl.robot.midranging.loop_model_kernel import adopt
from stagectl.robot.midranging.reference_governor import Governor
from stagectl.robot.midranging.tuning import LoopModel


@dataclass(frozen=True)
class Estimation:
    """The phase before control, in which square waves excite both loops and the estimators alone work.

    Parameters
    ----------
    seconds : float, s, >= 0
        It takes at least so long; at 0 control begins at once.
    accuracy : float, 1, > 0
        It goes on until the models' own outputs are off by less than this share of the measured ones (rms over about
        a period of the slow wave), noise apart.
    fast_amplitude, slow_amplitude : float, m, > 0
    fast_half_period, slow_half_period : float, s, > 0

    Raises
    ------
    ValueError : a value outside its range, by name.
    """

    seconds: float = 4.0
    accuracy: float = 0.05
    fast_amplitude: float = 0.5e-3
    slow_amplitude: float = 0.5e-3
    fast_half_period: float = 0.5
    slow_half_period: float = 1.0

    def __post_init__(self) -> None:
        """Refuse what cannot be."""
        if not 0.0 <= self.seconds < math.inf:
            raise ValueError(f"seconds is {self.seconds} s, must be finite and >= 0")
        for name, unit in (("fast_amplitude", " m"), ("slow_amplitude", " m"), ("fast_half_period", " s"),
                           ("slow_half_period", " s"), ("accuracy", "")):  # fmt: skip
            if not 0.0 < getattr(self, name) < math.inf:
                raise ValueError(f"{name} is {getattr(self, name)}{unit}, must be finite and > 0")


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

    Raises
    ------
    ValueError : a desired response has not the gain one, or the excitation would saturate or leave the travel.
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

    def __post_init__(self) -> None:
        """Refuse what cannot be."""
        for name in ("desired_fast", "desired_slow"):
            wanted: LoopModel = getattr(self, name)
            gain = sum(wanted.inputs) / (1.0 - sum(wanted.outputs))
            if not abs(gain - 1.0) < 1e-9:
                raise ValueError(
                    f"{name} has the gain {gain:g} at rest, must be 1: the fast manipulator would not return"
                )
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
    estimation phase is over) out, and `fast_model`, `slow_model`: the a and b in use of the first axis, the second ...

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
    The governor takes the position of the same sample for its prediction, so that the limit holds while the process
    changes; and it keeps the position within the travel as well.  An estimate without stable poles or with a gain far
    from one is not used; the last one that was goes on.  Where an input is no number, the models stand for the
    positions, and the last reference and the last disturbance go on.
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


def _packed(axis: InternalModelAxis, order: int, rate: float) -> np.void:
    """Return an axis as the kernel reads it, at its beginning, with models of `order`."""
    phase = axis.estimation
    record: np.void = np.zeros(1, AXIS)[0]
    record["order"], record["middle"], record["governor"] = order, axis.middle, axis.governor.packed(rate)
    record["least_samples"], record["accuracy"] = round(phase.seconds * rate), phase.accuracy**2
    record["forget"] = math.exp(-1.0 / (2.0 * phase.slow_half_period * rate))
    record["phase"] = ACTIVE if phase.seconds == 0.0 else ESTIMATING
    for name in ("fast", "slow"):
        loop, learning = record[name], getattr(axis, f"{name}_learning")
        loop["squares"] = learning.packed(getattr(axis, name).of_order(order).parameters, rate)
        loop["wanted"]["used"][: 2 * order] = getattr(axis, f"desired_{name}").of_order(order).parameters
        loop["noise"] = learning.noise**2
        loop["amplitude"] = getattr(phase, f"{name}_amplitude")
        loop["half_period"] = getattr(phase, f"{name}_half_period") * rate
        adopt(loop, order)
    return record
