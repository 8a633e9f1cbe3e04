"""The planner for uncertain durations beside the thesis' own: a slow side, and pockets of which nothing is known."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from benchmarks.page_table import table
from benchmarks.planning_chapter_7 import published
from benchmarks.planning_pockets import draw
from stagectl.planning.exact import least_time
from stagectl.planning.milling import Planner, mill, total
from stagectl.planning.pocket import planner
from stagectl.planning.problem import Pocket
from stagectl.planning.rate_belief import unknown
from stagectl.planning.sequential import Rule, SequentialPlanner
from stagectl.planning.uncertain import UncertainPlanner

TABLES = 25
SLOWDOWN = 1.4
POCKETS = 3
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
    first = mill(pocket, planner(name, pocket))[0].cut.side
    slow = replace(pocket, true={"theta": {first: SLOWDOWN}})
    return total(mill(slow, planner(name, slow))) / least_time(slow) - 1.0


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
