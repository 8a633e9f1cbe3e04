"""The program's own mid-ranging controllers on plain numbers: one axis, in any unit of length, sample by sample."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ctlblocks.block import Block
from stagectl.robot.midranging.array_loop import System, as_model
from stagectl.robot.midranging.axis_record import TAKEN_OVER
from stagectl.robot.midranging.design import Loops, ValveFactors, internal_model_axis, valve_axis
from stagectl.robot.midranging.estimation import Estimation
from stagectl.robot.midranging.internal_model import InternalModel
from stagectl.robot.midranging.least_squares import LeastSquares
from stagectl.robot.midranging.reference_governor import Governor
from stagectl.robot.midranging.valve_position import ValvePosition

WAVES = 4.0, 2.0
"""Half periods of the fast and the slow wave of the estimation phase, over the time constants of the loops."""


class Asked(NamedTuple):
    """What both loops are asked for: two positions."""

    fast: float
    slow: float


class Controller:
    """A mid-ranging controller of one axis; made by `valve_position` or `adaptive`.

    Parameters
    ----------
    block : Block
        The program's own, of one axis.
    rate : float, samples/s
    governor : Governor
        Limits and inner controller of the fast loop.
    lead : float, s
        Longest estimation phase, before which no reference is followed.
    """

    def __init__(self, block: Block, rate: float, governor: Governor, lead: float = 0.0) -> None:
        self.block, self.rate, self.governor, self.lead = block, rate, governor, lead
        self.reset()

    def reset(self) -> None:
        """Begin anew, with the first models and the estimation phase."""
        self.block.prepare(self.rate, 1)
        self._seen = [np.zeros((1, 1)) for _ in self.block.inputs]
        self._made = {port.name: np.zeros((1, port.width)) for port in self.block.outputs}

    def step(
        self, reference: float, relative: float, fast: float = 0.0, slow: float = 0.0, control: float = 0.0
    ) -> Asked:
        """Return what both loops are asked for until the next sample.

        Parameters
        ----------
        reference, relative : float, length
            Wanted and measured relative position, y_r = y_f + y_s + d.
        fast, slow : float, length
            Positions of both manipulators as measured; valve position control does not look at them.
        control : float, length/s
            The fast loop's inner control signal of the sample before, ahead of its saturation: for anti-windup.
        """
        told = {"reference": reference, "relative": relative, "fast": fast, "slow": slow, "control": control}
        for port, frame in zip(self.block.inputs, self._seen, strict=True):
            frame[0, 0] = told[port.name]
        self.block.process(*self._seen, *self._made.values())
        return Asked(float(self._made["fast_reference"][0, 0]), float(self._made["slow_reference"][0, 0]))

    @property
    def is_active(self) -> bool:
        """Whether the reference is followed: the estimation phase is over, or there is none."""
        return bool(self._made["active"][0, 0]) if "active" in self._made else True

    @property
    def has_taken_over(self) -> str:
        """Why valve position control has taken over from adaptive control; empty where it has not."""
        if "active" not in self._made or self._made["active"][0, 0] != TAKEN_OVER:
            return ""
        return self.block.reasons[0] if isinstance(self.block, InternalModel) else ""

    @property
    def models(self) -> dict[str, np.ndarray]:
        """The a, then the b, of both models in use, shape (2 order,), by "fast" and "slow"; none of valve position."""
        return {
            loop: self._made[f"{loop}_model"][0].copy() for loop in ("fast", "slow") if f"{loop}_model" in self._made
        }


def valve_position(
    fast: System,
    slow: System,
    rate: float,
    kind: str = "mvpc",
    *,
    inner: Sequence[float] = (1.0,),
    limit: float = math.inf,
    factors: ValveFactors | None = None,
) -> Controller:
    """Return valve position control, lambda-tuned from both loops reduced to first order.

    Parameters
    ----------
    fast, slow : (numerator, denominator) in falling powers of z, (A, B, C), (A, B, C, D), scipy's or control's
        The closed loops of the fast and the slow manipulator, discrete at `rate`, gain one at rest.
    rate : float, samples/s
    kind : str
        "vpc", "mvpc", or "mvpc-aw", with anti-windup.
    inner : sequence of float, 1/s
        Numerator of the fast loop's inner controller, in powers of z^-1.
    limit : float, length/s
        Where its control signal saturates.
    factors : ValveFactors, optional

    Raises
    ------
    ValueError : a loop that is none, an order above three, or another kind.

    Source
    ------
    Sörnmo 2015, sections 2.3 and 3.2.
    """
    governor = Governor(tuple(inner), limit=limit)
    axis = valve_axis(kind, _loops(fast, slow, rate), governor, factors or ValveFactors())
    return Controller(ValvePosition([axis]), rate, governor)


def adaptive(
    fast: System,
    slow: System,
    rate: float,
    *,
    wave: float,
    noise: float,
    order: int = 1,
    inner: Sequence[float] = (1.0,),
    limit: float = math.inf,
    travel: float = math.inf,
    forgetting: float = 0.999,
    estimation: Estimation | None = None,
) -> Controller:
    """Return adaptive internal model control, with dead times, of loops that are known about.

    Parameters
    ----------
    fast, slow, rate : as of `valve_position`
    wave : float, length
        Amplitude of both square waves of the estimation phase.
    noise : float, length
        Standard deviation of the positions' sensors, > 0; at least their resolution.
    order : int
        Of the models that are estimated, at least that of those given, at most 3.
    inner, limit : as of `valve_position`
    travel : float, length
        Of the fast manipulator, from its middle to either side.
    forgetting : float
        Of the least squares, > 0 to 1.
    estimation : Estimation, optional
        In place of `wave` and of waves as slow as the loops.

    Raises
    ------
    ValueError : a loop that is none, an order above three, or a value out of its range.

    Source
    ------
    Sörnmo 2015, chapter 3.
    """
    loops, governor = _loops(fast, slow, rate, order), Governor(tuple(inner), limit=limit, travel=travel)
    times = loops.times
    if estimation is None:
        halves = [factor * time for factor, time in zip(WAVES, times, strict=True)]
        estimation = Estimation(4.0 * halves[1], fast_amplitude=wave, slow_amplitude=wave,
                                fast_half_period=halves[0], slow_half_period=halves[1])  # fmt: skip
    learning = LeastSquares(forgetting, noise, smoothing=times[0], gate=3.0, alarm=True)
    axis = internal_model_axis(loops, governor, learning, estimation, ValveFactors())
    lead = max(estimation.seconds, estimation.half_periods * estimation.slow_half_period)
    return Controller(InternalModel([axis]), rate, governor, lead + 2.0 / rate if estimation.seconds else 0.0)


def _loops(fast: System, slow: System, rate: float, order: int = 1) -> Loops:
    if not 0.0 < rate < math.inf:
        raise ValueError(f"rate is {rate} samples/s, must be finite and > 0")
    models = []
    for name, system in (("fast", fast), ("slow", slow)):
        try:
            models.append(as_model(system))
        except ValueError as error:
            raise ValueError(f"{name}: {error}") from error
    (quick, early), (late, later) = models
    return Loops(quick, late, rate, early / rate, later / rate, order)
