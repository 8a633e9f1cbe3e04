"""Chapter 7's planner: strip by strip, on what was learned of each milling type, training itself on the way."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stagectl.planning import sequential_kernel as kernel
from stagectl.planning import strip_kernel
from stagectl.planning.milling import Milled
from stagectl.planning.problem import Pocket
from stagectl.planning.strips import Cut, Standing, costs
from stagectl.planning.training_set import NEARLY_NOTHING, Memory, TrainingSet


@dataclass(frozen=True)
class Rule:
    """What the planner minimizes, and how it trains itself.

    Parameters
    ----------
    eta : float, 1
        By so much a type that was milled once is taken to be faster than it was, so that it is tried again; > 1.
    force_weight : float, s per cell of area and N
        w1, on the mean of the force's standard deviation: 5 in the text, in ms/mm^2 and N.
    deviation_weight : float, 1
        w2 times the number of samples, on the standard deviation of the durations per area: -5 in the text.
    memory : Memory

    Source
    ------
    Sörnmo 2015, eqs. (7.35) and (7.37).
    """

    eta: float = 2.0
    force_weight: float = 0.0
    deviation_weight: float = 0.0
    memory: Memory = Memory()

    def __post_init__(self) -> None:
        """Refuse what trains nothing."""
        if not self.eta >= 1.0:
            raise ValueError(f"eta is {self.eta}, must be >= 1")


def trained(pocket: Pocket) -> dict[str, list[float]]:
    """Return training sets, s per cell, of two segments of each type at the rate that is believed."""
    return {name: [rate, rate] for name, rate in pocket.rate.items() if name[0] in "EW"}


class SequentialPlanner:
    """Mills in two directions by the rule of chapter 7, planned again after every segment.

    For each corner the whole rest is gone through with (7.29) to (7.34); the next strip is milled off the corner that
    costs least, moves included, so that the planner switches corners by itself.

    Parameters
    ----------
    pocket : Pocket
        Its rates are not looked at: `training` says what is known.
    training : mapping of type to sequence of float, s per cell
        The training sets; a type without one is tried out on the way.
    forces : mapping of type to sequence of float, N, optional
        The force's standard deviations beside them, as many.
    rule : Rule

    Source
    ------
    Sörnmo 2015, eqs. (7.27) to (7.37).

    Departs
    -------
    Where nothing is left after a strip, t_A is its own time per area and there is no way back: the text does not say.
    Only the types east and west are milled, in any pocket.
    """

    def __init__(
        self,
        pocket: Pocket,
        training: Mapping[str, Sequence[float]],
        rule: Rule = Rule(),  # noqa: B008  # frozen
        forces: Mapping[str, Sequence[float]] | None = None,
    ) -> None:
        self.rule = rule
        self.sets = {name: TrainingSet(rule.memory) for name in pocket.types if name[0] in "EW"}
        for name, rates in training.items():
            known = (forces or {}).get(name, [math.nan] * len(rates))
            for rate, force in zip(rates, known, strict=True):
                self.sets[name].add(rate, force)
        self._costs = costs(pocket)
        self._factor = np.array([pocket.theta.get(Cut(way, 1).side, 1.0) for way in range(len(self._costs.rate))])
        self._told = np.full((2, *self._costs.rate.shape), np.inf)
        for name in self.sets:
            self._tell(name)

    def choose(self, standing: Standing) -> Cut:
        """Return the strip to mill next."""
        cost, rectangle = self._costs, tuple(standing.uncut)
        rate, extra = self._told
        way, k = kernel.decide(standing.way, rectangle, cost.pocket, rate, cost.moves, extra)
        return Cut(way, k)

    def learn(self, milled: Milled) -> None:
        """Add a finished segment to the set of its type; of a feed to the north or south it makes nothing."""
        if milled.name not in self.sets:
            return
        cells = strip_kernel.length(milled.cut.way, tuple(milled.standing.uncut))
        rate = (milled.duration - self._costs.begin) / cells / self._factor[milled.cut.way]
        self.sets[milled.name].add(rate, milled.force_deviation)
        self._tell(milled.name)

    def _tell(self, name: str) -> None:
        """Set what a type is taken to cost: rate, s per cell, and what is added to its time per area, s per cell."""
        known = self.sets[name]
        count = known.count
        mean, extra, k = NEARLY_NOTHING, 0.0, int(name[1])
        if count:
            mean = known.mean() / (self.rule.eta if count == 1 else 1.0)
            extra = self.rule.deviation_weight / count * known.deviation() / k
            if math.isfinite(force := known.force()):
                extra += self.rule.force_weight * force
        for way in range(kernel.TWO_DIRECTIONS):
            if Cut(way, k).name(self._told.shape[2]) == name:
                self._told[:, way, k - 1] = mean * self._factor[way], extra
