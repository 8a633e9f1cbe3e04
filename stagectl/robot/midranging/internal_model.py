"""Adaptive internal model control of a macro and a micro manipulator, with a governor before the micro one."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.robot.midranging import internal_model_kernel as kernel
from stagectl.robot.midranging import loop_model_kernel as loop
from stagectl.robot.midranging import reference_governor_kernel as governor_kernel
from stagectl.robot.midranging.least_squares import LeastSquares
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
        axes, order = self._axes, self.order
        self._settings = np.array([_packed(axis, rate) for axis in axes])
        learning = [(axis.fast_learning, axis.slow_learning) for axis in axes]
        self._learning = np.array([[each.packed(rate) for each in both] for both in learning])
        self._limits = np.array([axis.governor.packed(rate) for axis in axes])
        guesses = [[each.of_order(order).parameters for each in (axis.fast, axis.slow)] for axis in axes]
        self._memory = np.array(
            [[each.memory(guess, rate) for each, guess in zip(*both, strict=True)]
             for both in zip(learning, guesses, strict=True)]
        )  # fmt: skip
        self._models = np.zeros((len(axes), 2, loop.CELLS))
        self._wanted = np.zeros((len(axes), 2, loop.CELLS))
        for number, axis in enumerate(axes):
            for which, wanted in enumerate((axis.desired_fast, axis.desired_slow)):
                self._wanted[number, which, loop.USED : loop.USED + 2 * order] = wanted.of_order(order).parameters
                loop.adopt(self._models[number, which], self._memory[number, which], order)
        self._inner = np.zeros((len(axes), governor_kernel.CELLS))
        self._phase = np.zeros((len(axes), kernel.CELLS))
        self._phase[:, kernel.PHASE] = [float(axis.estimation.seconds == 0.0) for axis in axes]

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
        kernel.run(
            reference, relative, fast, slow,
            fast_reference, slow_reference, control, share, active, fast_model, slow_model,
            self.order, self._settings, self._learning, self._limits,
            self._models, self._wanted, self._memory, self._inner, self._phase,
        )  # fmt: skip

    @property
    def blind(self) -> tuple[int, ...]:
        """In how many samples an input was no number since `prepare`, a number an axis."""
        return tuple(int(count) for count in self._phase[:, kernel.BLIND])


def _packed(axis: InternalModelAxis, rate: float) -> np.ndarray:
    """Return an axis as the kernel reads it, shape (settings,)."""
    phase = axis.estimation
    window = 2.0 * phase.slow_half_period * rate
    packed = np.zeros(kernel.SETTINGS)
    packed[[kernel.MIDDLE, kernel.LEAST_SAMPLES]] = axis.middle, round(phase.seconds * rate)
    packed[[kernel.ACCURACY, kernel.FORGET]] = phase.accuracy**2, math.exp(-1.0 / window)
    packed[kernel.NOISE : kernel.NOISE + 2] = axis.fast_learning.noise**2, axis.slow_learning.noise**2
    packed[kernel.AMPLITUDE : kernel.AMPLITUDE + 2] = phase.fast_amplitude, phase.slow_amplitude
    packed[kernel.HALF_PERIOD : kernel.HALF_PERIOD + 2] = phase.fast_half_period * rate, phase.slow_half_period * rate
    return packed
