"""The planner for uncertain durations beside the thesis' own: a slow side, and pockets of which nothing is known."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from zlib import crc32

import numpy as np

from benchmarks.page_table import table
from benchmarks.planning_chapter_7 import published
from benchmarks.planning_pockets import draw
from stagectl.planning.exact import least_time
from stagectl.planning.milling import Planner, mill, total
from stagectl.planning.pocket import planner
from stagectl.planning.problem import Pocket
from stagectl.planning.rate_belief import MEASURED, UNKNOWN, Prior, RateBelief, measured, unknown
from stagectl.planning.sequential import Rule, SequentialPlanner
from stagectl.planning.uncertain import UncertainPlanner

TABLES = 25
SLOWDOWN = 1.4
POCKETS = 3
DRAWN = float("nan")
"""For a degree of optimism."""
TRAINING: dict[str, Callable[[Pocket], Planner]] = {
    "sequential, eta 2": lambda pocket: SequentialPlanner(pocket, {}),
    "sequential, eta 1.25": lambda pocket: SequentialPlanner(pocket, {}, Rule(eta=1.25)),
    "uncertain": lambda pocket: UncertainPlanner(pocket, unknown(pocket)),
}


def slow_side() -> str:
    """Return the table of a side that costs 40 % more than is believed: the one that the planner begins with."""
    rng = np.random.default_rng(40)
    pockets = [draw(rng, 18, 18, 2, "EWNS")[0] for _ in range(TABLES)]
    rows = []
    for name in ("qlearning", "features", "exact", "uncertain"):
        gaps = np.array([_slowed(name, pocket) for pocket in pockets])
        rows.append([name, f"{100 * gaps.mean():.2f}", f"{100 * gaps.max():.2f}"])
    return table(["planner", "mean over the optimum, %", "worst, %"], rows)


def _slowed(name: str, pocket: Pocket) -> float:
    return _slowed_by(lambda each: planner(name, each), pocket)


def _slowed_by(made: Callable[[Pocket], Planner], pocket: Pocket) -> float:
    first = mill(pocket, made(pocket))[0].cut.side
    slow = replace(pocket, true={"theta": {first: SLOWDOWN}})
    return total(mill(slow, made(slow))) / least_time(slow) - 1.0


def optimism() -> str:
    """Return the table of degrees of optimism, and of rates drawn from the belief."""
    rng = np.random.default_rng(42)
    known = [draw(rng, 12, 12, 2, "EWNS")[0] for _ in range(TABLES)]
    strange = [draw(rng, 18, 18, 3, "EW")[0] for _ in range(TABLES)]
    rows = []
    for degree in (0.0, 0.25, 0.5, 1.0, DRAWN):
        slow = np.mean([_slowed_by(lambda pocket, at=degree: _at(at, MEASURED, pocket), each) for each in known])
        three = np.mean([_three(lambda pocket, at=degree: _at(at, UNKNOWN, pocket), each) for each in strange])
        name = "drawn from the belief" if np.isnan(degree) else f"{degree:g} deviations below the median"
        rows.append([name, f"{100 * slow:.2f}", f"{100 * three:.2f}"])
    return table(["planned on rates", "a side 40 % slower, %", "three pockets, nothing known, %"], rows)


class _DrawnBelief(RateBelief):
    """Plans count on rates drawn anew after each segment: Thompson sampling."""

    def hoped_for(self) -> np.ndarray:
        """Draw rates, shape (ways x tool,), s per cell."""
        rng = np.random.default_rng(crc32(self.mean.tobytes()))
        return np.asarray(np.exp(rng.multivariate_normal(self.mean, self.covariance, method="eigh")))


def _at(degree: float, prior: Prior, pocket: Pocket) -> Planner:
    began = measured(pocket) if prior is MEASURED else unknown(pocket)
    kind = _DrawnBelief if np.isnan(degree) else RateBelief
    rate = np.exp(began.mean).reshape(-1, pocket.G)
    return UncertainPlanner(pocket, kind(pocket, rate, replace(prior, optimism=0.0 if np.isnan(degree) else degree)))


def self_training() -> str:
    """Return the table of three pockets milled by planners that know no rate."""
    rng = np.random.default_rng(41)
    kinds = {
        "chapter 7": [published()],
        f"halves, 14 x 14, {TABLES} tables": [draw(rng, 14, 14, 2, "EW")[0] for _ in range(TABLES)],
        f"thirds, 18 x 18, {TABLES} tables": [draw(rng, 18, 18, 3, "EW")[0] for _ in range(TABLES)],
        f"the same, rates 0.5 to 2 whatever k, {TABLES} tables": [_unrelated(rng) for _ in range(TABLES)],
    }
    rows = []
    for kind, pockets in kinds.items():
        for name, made in TRAINING.items():
            gaps = np.mean([_three(made, pocket) for pocket in pockets], axis=0)
            rows.append([kind, name, *(f"{100 * gap:.1f}" for gap in gaps), f"{100 * gaps.mean():.1f}"])
    return table(["rates", "planner", "pocket 1, %", "pocket 2, %", "pocket 3, %", "all, %"], rows)


def _unrelated(rng: np.random.Generator) -> Pocket:
    pocket, _ = draw(rng, 18, 18, 3, "EW")
    return replace(pocket, rate={name: float(rng.uniform(0.5, 2.0)) for name in pocket.rate})


def _three(made: Callable[[Pocket], Planner], pocket: Pocket) -> Sequence[float]:
    chosen, least = made(pocket), least_time(pocket)
    return [total(mill(pocket, chosen)) / least - 1.0 for _ in range(POCKETS)]
