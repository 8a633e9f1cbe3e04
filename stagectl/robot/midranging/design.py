"""Controllers of one axis designed from the models of both loops: the choices that every caller shares."""

import math
from dataclasses import dataclass, replace

from stagectl.robot.midranging.estimation import Estimation
from stagectl.robot.midranging.internal_model import InternalModelAxis
from stagectl.robot.midranging.least_squares import LeastSquares
from stagectl.robot.midranging.reference_governor import Governor
from stagectl.robot.midranging.tuning import LoopModel, integral, lambda_tuned
from stagectl.robot.midranging.valve_position import ValvePositionAxis

KINDS = ("vpc", "mvpc", "mvpc-aw")
"""Of valve position control."""


@dataclass(frozen=True)
class Loops:
    """Both loops as they were identified.

    Parameters
    ----------
    fast, slow : LoopModel
    rate : float, samples/s
    fast_delay, slow_delay : float, s
    order : int
        Of the models that are estimated; that of the given ones where they are higher.
    middle : float, m
        Of the micro manipulator's travel.
    """

    fast: LoopModel
    slow: LoopModel
    rate: float
    fast_delay: float = 0.0
    slow_delay: float = 0.0
    order: int = 1
    middle: float = 0.0

    @property
    def times(self) -> tuple[float, float]:
        """Time constants of the fast and the slow loop reduced to first order, s."""
        return self.fast.time_constant(self.rate), self.slow.time_constant(self.rate)


@dataclass(frozen=True)
class ValveFactors:
    """What valve position control is tuned for.

    Parameters
    ----------
    fast_factor, slow_factor : float, > 0
        Time constant wanted of a loop over its own.
    tracking_factor : float, > 0
        Anti-windup time over the fast loop's time constant.
    feed : float, 0 to 1
        Share of what the slow loop is about to do that is taken off the fast reference.
    """

    fast_factor: float = 1.0
    slow_factor: float = 1.0
    tracking_factor: float = 1.0
    feed: float = 0.0


def valve_axis(kind: str, loops: Loops, governor: Governor, factors: ValveFactors) -> ValvePositionAxis:
    """Return valve position control of one of `KINDS`, lambda-tuned from the loops reduced to first order.

    Parameters
    ----------
    kind : str
    loops : Loops
    governor : Governor
        Whose limit and inner controller anti-windup needs.
    factors : ValveFactors

    Raises
    ------
    ValueError : another kind, or a value out of its range.

    Source
    ------
    Sörnmo 2015, sections 2.3 and 3.2.
    """
    if kind not in KINDS:
        raise ValueError(f"kind is {kind!r}, must be one of {', '.join(KINDS)}")
    fast, slow = loops.times
    wanted = factors.slow_factor * slow
    return ValvePositionAxis(
        fast=lambda_tuned(fast, factors.fast_factor * fast),
        slow=integral(wanted) if kind == "vpc" else lambda_tuned(slow, wanted),
        middle=loops.middle,
        tracking=factors.tracking_factor * fast if kind == "mvpc-aw" else math.inf,
        limit=governor.limit,
        inner_gain=governor.direct,
        slow_time_constant=slow,
        feed=factors.feed,
    )


def internal_model_axis(
    loops: Loops, governor: Governor, learning: LeastSquares, estimation: Estimation, factors: ValveFactors
) -> InternalModelAxis:
    """Return adaptive internal model control that keeps the bandwidths of both loops, as (3.14) does.

    The desired responses are of first order with the loops' time constants.

    Parameters
    ----------
    loops : Loops
    governor : Governor
    learning : LeastSquares
        Of both loops; its smoothing is replaced by each loop's time constant.
    estimation : Estimation
    factors : ValveFactors
        Of the valve position control that takes over.

    Raises
    ------
    ValueError : a value out of its range.

    Source
    ------
    Sörnmo 2015, sections 3.2 and 3.3.
    """
    fast, slow = loops.times
    order = max(loops.order, loops.fast.order, loops.slow.order)
    return InternalModelAxis(
        fast=loops.fast.of_order(order),
        slow=loops.slow.of_order(order),
        desired_fast=LoopModel.first_order(fast, loops.rate),
        desired_slow=LoopModel.first_order(slow, loops.rate),
        governor=governor,
        fast_learning=replace(learning, smoothing=fast),
        slow_learning=replace(learning, smoothing=slow),
        middle=loops.middle,
        estimation=estimation,
        fast_delay=loops.fast_delay,
        slow_delay=loops.slow_delay,
        valve=valve_axis("mvpc-aw", loops, governor, factors),
    )
