"""The outer loop's design: of all that are as robust as asked for, the one that suppresses disturbances most."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from stagectl.config import Outer
from stagectl.models import InnovationModel
from stagectl.stage.kalman import kalman_gain
from stagectl.stage.sensitivity import Robustness, frequencies, is_stable, robustness
from stagectl.stage.servo import servo
from stagectl.stage.state_feedback import StateFeedback, linear_quadratic, ramp_feedforward
from stagectl.stage.state_space import StateSpace, plant_of

DOUBTS = (0.0, *np.geomspace(1e-3, 1e1, 9))
"""Noise at the input that the Kalman filter is made for, re the innovations: what the design chooses from."""
CAUTIONS = (0.0, 1.0, 3.0, 10.0)
"""Weight of each mode for itself, in filter and feedback: what the design chooses from."""
BANDWIDTHS = 0.7 ** np.arange(8)
"""Of the integral action, re the one asked for: what the design chooses from."""


@dataclass(frozen=True, eq=False)
class Design:
    """An outer loop, and how it came about.

    Parameters
    ----------
    loop : StateFeedback
    robustness : Robustness
        On the model, with the extra delay of `Outer.delay`.
    worst_sensitivity : float, 1
        Ms where natural frequencies are off by `Outer.mistuning` either way, or not.
    suppression : float, 1
        |S| at `Outer.disturbance`.
    bandwidth : float, Hz
        Of the integral action, as designed.
    doubt : float, m/m
    caution : float, 1
        Of `kalman_gain` and `linear_quadratic`.
    """

    loop: StateFeedback
    robustness: Robustness
    worst_sensitivity: float
    suppression: float
    bandwidth: float
    doubt: float
    caution: float


def design(model: InnovationModel, outer: Outer, axis: int) -> Design:
    """Design the outer loop of an axis from its weights.

    Of the bandwidths up to the one asked for, and of filters and gains of more and less trust in the model, it takes
    the combination that suppresses a disturbance at `Outer.disturbance` most while Ms keeps its bound, with the extra
    delay and with natural frequencies off by `Outer.mistuning` either way.

    Parameters
    ----------
    model : InnovationModel
        From the inner loop's reference (m) to the plate's position (m).
    outer : Outer
    axis : int, counted from 0

    Raises
    ------
    ValueError : no combination keeps the bound.
    """
    plants = [mistuned(plant_of(model), 1.0 + off) for off in sorted({0.0, -outer.mistuning, outer.mistuning}, key=abs)]
    looks = _Looks(plants, model.rate, outer)
    found = sorted(
        ((*looks.at(each.loop.system()), each) for each in _candidates(model, outer, axis)), key=lambda each: each[1]
    )
    for worst, suppression, each in found:
        if worst > outer.max_sensitivity:
            continue
        figures = [robustness(plant, each.loop.system(), model.rate, outer.delay) for plant in plants]
        worst = max(figure.max_sensitivity for figure in figures)
        if worst <= outer.max_sensitivity:
            loop = replace(each.loop, forward=outer.feedforward * ramp_feedforward(each.loop))
            return replace(
                each, loop=loop, robustness=figures[0], worst_sensitivity=worst, suppression=float(suppression)
            )
    raise ValueError(
        f"axis {axis + 1}: no outer loop keeps outer.max_sensitivity {outer.max_sensitivity:g} on this model, the "
        f"least is {min(worst for worst, _, _ in found):.3g}; lower outer.bandwidth or outer.mistuning"
    )


def mistuned(plant: StateSpace, factor: float) -> StateSpace:
    """Return a plant whose natural frequencies are multiplied by a factor; damping ratios and gain at rest stay."""
    if factor == 1.0:
        return plant
    poles, shapes = np.linalg.eig(plant.A.astype(complex))
    moved = np.where(np.abs(poles.imag) > 0, np.exp(factor * np.log(poles + (poles == 0))), poles)
    turned = np.linalg.solve(shapes.T, (shapes * moved).T).T.real
    unit = np.eye(len(plant.A))
    return StateSpace(turned, (unit - turned) @ np.linalg.solve(unit - plant.A, plant.B), plant.C, plant.D)


class _Looks:
    """A quick look at many controllers of the same plants: Ms on one set of frequencies."""

    def __init__(self, plants: list[StateSpace], rate: float, outer: Outer) -> None:
        self._plants, self._rate, self._delay = plants, rate, outer.delay
        frequency = frequencies(plants, rate)[::2]
        self._frequency = np.append(frequency, outer.disturbance)
        self._responses = np.array([plant.response(self._frequency, rate) for plant in plants])
        self._late = np.exp(-2j * np.pi * self._frequency * outer.delay / rate)

    def at(self, controller: StateSpace) -> tuple[float, float]:
        """Return Ms, infinite where a loop is unstable, and |S| at the disturbance."""
        gain = controller.response(self._frequency, self._rate) * self._responses
        distance = np.minimum(np.abs(1.0 + gain), np.abs(1.0 + gain * self._late))
        suppression, worst = 1.0 / abs(1.0 + gain[0, -1]), 1.0 / distance.min()
        loops = (controller.then(plant).delayed(late) for plant in self._plants for late in {0, self._delay})
        return (worst if all(map(is_stable, loops)) else np.inf), suppression


def _candidates(model: InnovationModel, outer: Outer, axis: int) -> Iterator[Design]:
    wanted, drive = outer.bandwidth[axis % len(outer.bandwidth)], outer.drive[axis % len(outer.drive)]
    unknown = Robustness(False, np.inf, 0.0, (0.0, 0.0), 0.0, 0.0, 0.0)
    for caution in CAUTIONS:
        gains = [(doubt, kalman_gain(model, doubt, caution)) for doubt in DOUBTS]
        for bandwidth in wanted * BANDWIDTHS:
            states = servo(outer, bandwidth, model.rate)
            feedback, servo_feedback = linear_quadratic(model, states, drive, caution)
            for doubt, gain in gains:
                loop = StateFeedback(model, gain, feedback, states, servo_feedback)
                yield Design(loop, unknown, np.inf, np.inf, float(bandwidth), float(doubt), caution)
