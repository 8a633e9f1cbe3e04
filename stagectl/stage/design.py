"""The outer loop's design: of all that are as robust as asked for, the one that leaves the least error."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from stagectl.config import Outer
from stagectl.models import InnovationModel
from stagectl.stage.kalman import kalman_gain
from stagectl.stage.sensitivity import Robustness, frequencies, is_stable, robustness
from stagectl.stage.servo import servo
from stagectl.stage.state_feedback import StateFeedback, linear_quadratic, ramp_feedforward
from stagectl.stage.state_space import StateSpace, plant_of

DOUBTS = (0.0, 0.01, 0.03, 0.1, 0.3)
"""Noise at the input that the Kalman filter is made for, re the innovations: what the design chooses from."""
CAUTIONS = (0.0, 1.0, 3.0)
"""Weight of each mode for itself, in filter and feedback: what the design chooses from."""
BANDWIDTHS, DRIVES, FORWARDS = 0.5 ** np.arange(5), 0.3 ** np.arange(4), (1.0, 0.5, 0.2)
"""Re those asked for: what the design chooses from."""
SLOWER = 10.0
"""How many times slower than what is to be followed the pushes change that are to be resisted."""


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
    left : float, 1
        What is left of a reference that moves at `Outer.disturbance` and of a push that changes `SLOWER`: root of
        the sum of both squares.
    bandwidth, drive : float, Hz and m/m
        Of the integral action, and of `linear_quadratic`, as designed.
    doubt : float, m/m
    caution : float, 1
        Of `kalman_gain` and `linear_quadratic`.
    """

    loop: StateFeedback
    robustness: Robustness
    worst_sensitivity: float
    left: float
    bandwidth: float
    drive: float
    doubt: float
    caution: float


def design(model: InnovationModel, outer: Outer, axis: int) -> Design:
    """Design the outer loop of an axis from its weights.

    Of bandwidths and drives up to those asked for, and of filters and gains of more and less trust in the model, it
    takes the combination that leaves the least error (`Design.left`) while these keep their bounds: the gain above
    `Outer.reach`; Ms, with the extra delay; Ms with natural frequencies off by `Outer.mistuning` either way, and
    the largest answer to a reference, off or not.

    Parameters
    ----------
    model : InnovationModel
        From the inner loop's reference (m) to the plate's position (m).
    outer : Outer
    axis : int, counted from 0

    Raises
    ------
    ValueError : no combination keeps the bounds.
    """
    plants = [mistuned(plant_of(model), 1.0 + off) for off in sorted({0.0, -outer.mistuning, outer.mistuning}, key=abs)]
    looks = _Looks(plants, model.rate, outer)
    found = sorted(_candidates(model, outer, axis, looks), key=lambda each: each.left)
    for each in found:
        if not looks.keeps_bounds(each.loop):
            continue
        figures = [robustness(plant, each.loop.system(), model.rate, outer.delay) for plant in plants]
        worst = max(figure.max_sensitivity for figure in figures)
        answer = max(largest_answer(plant, each.loop) for plant in plants)
        if figures[0].max_sensitivity <= outer.max_sensitivity and max(worst, answer) <= outer.mistuned_sensitivity:
            return replace(each, robustness=figures[0], worst_sensitivity=worst)
    raise ValueError(
        f"axis {axis + 1}: of {len(found)} outer loops with a gain <= {_of(outer.beyond, axis):g} above outer.reach "
        f"{outer.reach:g} Hz none keeps outer.max_sensitivity {outer.max_sensitivity:g} and "
        f"outer.mistuned_sensitivity {outer.mistuned_sensitivity:g}; raise these, or lower outer.mistuning"
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


def _of(values: tuple[float, ...], axis: int) -> float:
    """Return the setting of an axis: there is one for all, or one an axis."""
    return values[axis % len(values)]


def largest_answer(plant: StateSpace, loop: StateFeedback) -> float:
    """Return the largest gain from reference to position of a loop on a plant, m/m."""
    rate = loop.model.rate
    frequency = frequencies([plant, loop.system().then(plant).closed()], rate)
    response = plant.response(frequency, rate)
    closed = loop.reference_system().response(frequency, rate) * response
    return float(np.abs(closed / (1.0 + loop.system().response(frequency, rate) * response)).max())


class _Looks:
    """A quick look at many controllers of the same plants, on one set of frequencies."""

    def __init__(self, plants: list[StateSpace], rate: float, outer: Outer) -> None:
        self._plants, self._rate, self._outer = plants, rate, outer
        self._frequency = frequencies(plants, rate)[::2]
        self._responses = np.array([plant.response(self._frequency, rate) for plant in plants])
        self._late = np.exp(-2j * np.pi * self._frequency * outer.delay / rate)
        self._beyond = np.geomspace(outer.reach, rate / 2, 30) if outer.reach < rate / 2 else np.zeros(0)
        self._few = np.append(self._beyond, [outer.disturbance, outer.disturbance / SLOWER])
        self._at_rest = abs(plants[0].response(np.zeros(1), rate)[0])
        self._few_responses = plants[0].response(self._few, rate)

    def gain_beyond_and_left(self, loop: StateFeedback) -> tuple[float, float]:
        """Return the controller's gain above `Outer.reach`, times the plant's at rest, and `Design.left`."""
        feedback = loop.system().response(self._few, self._rate)
        gain = feedback[-2:] * self._few_responses[-2:]
        at = slice(len(self._few) - 2, len(self._few) - 1)
        followed = loop.reference_system().response(self._few[at], self._rate) * self._few_responses[at]
        left = np.hypot(abs(1.0 - followed[0] / (1.0 + gain[-2])), abs(1.0 / (1.0 + gain[-1])))
        return float(np.abs(feedback[:-2]).max(initial=0.0)) * self._at_rest, float(left)

    def keeps_bounds(self, loop: StateFeedback) -> bool:
        """Whether Ms and answers to a reference are within their bounds, and all is stable."""
        controller, outer = loop.system(), self._outer
        gain = controller.response(self._frequency, self._rate) * self._responses
        distance = np.minimum(np.abs(1.0 + gain), np.abs(1.0 + gain * self._late))
        answer = loop.reference_system().response(self._frequency, self._rate) * self._responses / (1.0 + gain)
        if not (
            distance[0].min() * outer.max_sensitivity >= 1.0
            and distance.min() * outer.mistuned_sensitivity >= 1.0
            and np.abs(answer).max() <= outer.mistuned_sensitivity
        ):
            return False
        delays = {0, outer.delay}
        loops = (controller.then(plant).delayed(late) for plant in self._plants for late in delays)
        return all(map(is_stable, loops))


def _candidates(model: InnovationModel, outer: Outer, axis: int, looks: _Looks) -> Iterator[Design]:
    """Make the loops whose gain is low enough where the model does not reach."""
    wanted, most = _of(outer.bandwidth, axis), _of(outer.drive, axis)
    unknown = Robustness(False, np.inf, 0.0, (0.0, 0.0), 0.0, 0.0, 0.0)
    for caution in CAUTIONS:
        gains = [(doubt, kalman_gain(model, doubt, caution)) for doubt in DOUBTS]
        for bandwidth, drive in product(wanted * BANDWIDTHS, most * DRIVES):
            states = servo(outer, bandwidth, model.rate)
            feedback, servo_feedback = linear_quadratic(model, states, drive, caution)
            plain = StateFeedback(model, gains[0][1], feedback, states, servo_feedback)
            forward = outer.feedforward * ramp_feedforward(plain)  # the same for every filter
            for (doubt, gain), part in product(gains, FORWARDS):
                loop = replace(plain, gain=gain, forward=part * forward)
                beyond, left = looks.gain_beyond_and_left(loop)
                if beyond <= _of(outer.beyond, axis):
                    yield Design(loop, unknown, np.inf, left, float(bandwidth), float(drive), doubt, caution)
