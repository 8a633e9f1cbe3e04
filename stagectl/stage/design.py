"""The outer loop's design: of all that are as robust as asked for, the one that leaves the least error."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from calibration.state_space.model import InnovationModel
from stagectl.config import Outer
from stagectl.stage.allowed_gains import AllowedGains, configured, of_axis
from stagectl.stage.design_bounds import Looks, Reached, largest_answer, mistuned
from stagectl.stage.measured_response import MeasuredResponse
from stagectl.stage.sensitivity import Robustness, robustness
from stagectl.stage.state_feedback import StateFeedback
from stagectl.stage.state_space import plant_of
from stagectl.stage.weights import Ranges, Weights, loops

SHARES = Ranges(
    bandwidth=tuple(0.5 ** np.arange(5)),
    drive=tuple(0.3 ** np.arange(4)),
    trust_and_doubt=((1.0, 0.0), (0.0, 0.01), (0.0, 0.03), (0.0, 0.1), (0.0, 0.3)),
    caution=(0.0, 1.0, 3.0),
    feedforward=(1.0, 0.5, 0.2, 0.0),
)
"""What the design chooses from; bandwidth, drive and feedforward re those asked for.  The identified filter knows the
hysteresis of the chirps, the others are made for noise in the input."""

FAINTER = 1.0, 0.03
"""Part of the bandwidths and drives asked for, tried in turn where no loop keeps its bounds."""
ROUNDED = 1.02
"""Re its bound: what a loop may reach that was chosen before, by another version or on another machine."""
NOTCHES = 0.8, 1.2
"""Damping ratio of the notches' poles, tried after that."""


@dataclass(frozen=True, eq=False)
class Design:
    """An outer loop, and how it came about.

    Parameters
    ----------
    loop : StateFeedback
    weights : Weights
        What it is made of.
    robustness : Robustness
        On the model, with the extra delay of `Outer.delay`.
    worst_sensitivity : float, 1
        Ms where natural frequencies are off by `Outer.mistuning` either way, or not.
    left : float, 1
        Root of the sum of the squares of: what is left of a reference that moves at `Outer.disturbance`; of one
        `FASTER` and smaller; of a push that changes `SLOWER`; `Outer.compliance` times the answers to forces at
        `Outer.disturbance` and at that over `FASTER`; `Outer.push` times the answer to a push that rings.  Answers are
        re the plant at rest.
    beyond : float, 1
        Largest gain of the controller above `Outer.reach`, from the error, re the plant at rest.
    forward_share : float, 1
        Of the gains from the reference that are allowed at each frequency there, the largest.
    """

    loop: StateFeedback
    weights: Weights
    robustness: Robustness
    worst_sensitivity: float
    left: float
    beyond: float
    forward_share: float = 1.0


@dataclass(frozen=True, eq=False)
class Candidate:
    """A loop that was made, what it reaches above `Outer.reach`, and the error that it leaves, `Design.left`."""

    weights: Weights
    loop: StateFeedback
    beyond: Reached
    left: float


class NoLoop(ValueError):
    """No outer loop keeps its bounds.

    Parameters
    ----------
    why : str
    nearest : Candidate or None
        That keeps them best; None where none leaves less error than no loop.
    """

    def __init__(self, why: str, nearest: Candidate | None) -> None:
        super().__init__(why)
        self.nearest = nearest


def design(model: InnovationModel, outer: Outer, axis: int, weights: Weights | None = None) -> Design:
    """Design the outer loop of an axis, by weights that were chosen for its model, or choose them: see `chosen`.

    Parameters
    ----------
    model : InnovationModel
        From the inner loop's reference (m) to the plate's position (m).
    outer : Outer
    axis : int, counted from 0
    weights : Weights, optional

    Raises
    ------
    NoLoop : no combination keeps the bounds, or the one that was chosen does not.
    """
    allowed = configured(outer, axis, model.rate, weights.beyond if weights is not None else 0.0)
    found = chosen(Search(model, outer, axis, allowed), weights)
    return found if weights is None else replace(found, forward_share=weights.forward_share)


def chosen(search: "Search", weights: Weights | None = None) -> Design:
    """Take the loop of some weights, or the best there is.

    Of bandwidths and drives up to those asked for, of filters and gains of more and less trust in the model, and with
    `notches` where there is none without, it takes the combination that leaves the least error (`Design.left`) while
    these keep their bounds: the gain above `Outer.reach`; Ms, with the extra delay; Ms with natural frequencies off by
    `Outer.mistuning` either way, and the largest answer to a reference, off or not; and, where the plant was heard, Ms
    and the gain of a deflection's compensation as measured.

    Parameters
    ----------
    search : Search
    weights : Weights, optional

    Raises
    ------
    NoLoop : no combination keeps the bounds, or the one that was chosen does not.
    """
    outer, tried = search.outer, 0
    known: list[tuple[Candidate, Reached]] = []
    for ranges in _asked_for(outer, search.axis) if weights is None else [only(weights)]:
        made = list(search.candidates(ranges))
        tried += len(made)
        useful = [each for each in made if each.left <= search.useless or weights is not None]
        for each in sorted(useful, key=lambda each: each.left):
            reached = each.beyond if each.beyond.over(outer) > 1.0 else search.reached(each)
            if reached.over(outer) <= (1.0 if weights is None else ROUNDED):
                return search.design(each)
            known.append((each, reached))
    raise _no_loop(search, tried, known)


class Search:
    """Loops made for a model, and whether they keep their bounds.

    Parameters
    ----------
    model : InnovationModel
    outer : Outer
    axis : int, counted from 0
    allowed : AllowedGains
    measured : MeasuredResponse, optional
        What loops are held against as well.
    """

    def __init__(
        self,
        model: InnovationModel,
        outer: Outer,
        axis: int,
        allowed: AllowedGains,
        measured: MeasuredResponse | None = None,
    ) -> None:
        offs = sorted({0.0, -outer.mistuning, outer.mistuning}, key=abs)
        self.model, self.outer, self.axis = model, outer, axis
        self._plants = [mistuned(plant_of(model), 1.0 + off) for off in offs]
        self._looks = Looks(self._plants, model.rate, outer, allowed, measured)
        self.useless = self._looks.useless

    def candidates(self, ranges: Ranges) -> Iterator[Candidate]:
        """Make the loop of every combination."""
        for weights, loop in loops(self.model, self.outer, ranges):
            yield Candidate(weights, loop, *self._looks.beyond_and_left(loop))

    def reached(self, each: Candidate) -> Reached:
        """Return what of the bounded a loop reaches: after a quick look, where that keeps the bounds, exactly."""
        quick = self._looks.reached(each.loop, each.beyond)
        if quick.over(self.outer) > 1.0:
            return quick
        figures = self._figures(each)
        worst = max(figure.max_sensitivity for figure in figures)
        answer = max(largest_answer(plant, each.loop) for plant in self._plants)
        return replace(quick, sensitivity=figures[0].max_sensitivity, mistuned_sensitivity=worst, answer=answer)

    def design(self, each: Candidate) -> Design:
        """Return the design that a candidate makes."""
        figures = self._figures(each)
        worst = max(figure.max_sensitivity for figure in figures)
        beyond = each.beyond
        return Design(each.loop, each.weights, figures[0], worst, each.left, beyond.beyond, beyond.forward_share)

    def _figures(self, each: Candidate) -> list[Robustness]:
        controller, outer = each.loop.system(), self.outer
        return [robustness(plant, controller, self.model.rate, outer.delay) for plant in self._plants]


def _asked_for(outer: Outer, axis: int) -> Iterator[Ranges]:
    """Return what is tried in turn, until a loop keeps its bounds."""
    for notch, part in product([(0.0,), NOTCHES], FAINTER):
        bandwidth, drive = part * of_axis(outer.bandwidth, axis), part * of_axis(outer.drive, axis)
        yield replace(
            SHARES,
            bandwidth=[float(bandwidth * share) for share in SHARES.bandwidth],
            drive=[float(drive * share) for share in SHARES.drive],
            feedforward=[outer.feedforward * share for share in SHARES.feedforward],
            notch=notch,
        )


def only(weights: Weights) -> Ranges:
    """Return ranges of these weights alone."""
    pair = weights.trust, weights.doubt
    return Ranges(
        (weights.bandwidth,), (weights.drive,), (pair,), (weights.caution,), (weights.feedforward,), (weights.notch,)
    )


def _no_loop(search: Search, tried: int, known: list[tuple[Candidate, Reached]]) -> NoLoop:
    model, outer, axis = search.model, search.outer, search.axis
    if not known:
        why = "there is no LQ gain for this model" if tried == 0 else f"none of {tried} outer loops reduces the error"
        return NoLoop(f"axis {axis + 1}: {why}: has it a gain at rest, and at each resonance?", None)
    nearest, reached = min(known, key=lambda each: (not each[1].is_looked_at, each[1].over(outer)))
    advice = (
        "the loop of [weights] violates its bounds; calibrate again, or leave [weights] out: it has"
        if tried == 1
        else f"none of {tried} outer loops meets its bounds; binding is {reached.binding(outer)}; the nearest has"
    )
    return NoLoop(
        f"axis {axis + 1}: {advice} {reached}; allowed are Ms {outer.max_sensitivity:g}, mistuned and answer "
        f"{outer.mistuned_sensitivity:g}"
        f"{_narrow(model, outer.mistuning) if reached.mistuned_sensitivity == np.inf else ''}",
        nearest,
    )


def _narrow(model: InnovationModel, mistuning: float) -> str:
    """Say which resonance is narrower than its frequency is known, where one is."""
    modes = model.modes
    rings = (modes.damping > 0) & (modes.damping < min(mistuning, 1.0))
    if not rings.any():
        return ""
    least = int(np.argmin(np.where(rings, modes.damping, np.inf)))
    return (
        f"; the resonance at {modes.frequency[least]:.4g} Hz has a damping ratio of {modes.damping[least]:.2g}, and "
        f"its frequency may be off by outer.mistuning, {mistuning:g}"
    )
