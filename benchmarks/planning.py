"""The planners against the optimum, on random tables and in the thesis' scenarios: the tables of docs/planning.md.

`python -m benchmarks.planning [two] [four] [slowdown] [slow] [training] [optimism] [chapter7]`, all by default;
some minutes.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from benchmarks.page_table import put, table, words
from benchmarks.planning_chapter_7 import chapter_7
from benchmarks.planning_pockets import LIFT, draw
from benchmarks.planning_uncertain import optimism, self_training, slow_side
from stagectl.planning.milling import mill, total
from stagectl.planning.pocket import planner
from stagectl.planning.problem import Pocket

OPTIMAL = 1e-9
SLOWDOWN = 1.4
SOON = 3
LIFTS = (1.0, 8.0)
"""s, of the slowdown."""


def two_directions(tables: int = 200) -> None:
    """Compare chapter 7's rule and Q-learning on pockets of two directions."""
    rows = []
    for size in (12, 13):
        pockets = list(drawn(tables, size, size, "EW"))
        for name in ("sequential", "qlearning"):
            rows.append([f"{size} x {size}", name, *_told(gaps(name, pockets))])
    put(table(["cells", "planner", "optimal, %", "mean gap, %", "worst, %"], rows), "planning.md", "two directions")


def four_directions(tables: int = 50) -> None:
    """Compare the features, and for what two directions cost, Q-learning, on pockets of four."""
    rows = []
    for size in ((12, 12), (18, 18), (10, 20)):
        pockets = list(drawn(tables, *size, "EWNS"))
        for name in ("features", "qlearning"):
            rows.append([f"{size[0]} x {size[1]}", name, *_told(gaps(name, pockets))])
    put(table(["cells", "planner", "optimal, %", "mean gap, %", "worst, %"], rows), "planning.md", "four directions")


def slowdown(tables: int = 50) -> None:
    """Make what is cut from the side that a planner begins with 40 % slower, and see when it leaves that side."""
    rows = []
    for lift in LIFTS:
        pockets = [pocket for pocket, _ in drawn(tables, 18, 18, "EWNS", lift)]
        runs = {name: np.array([slowed(name, pocket) for pocket in pockets]) for name in ("qlearning", "features")}
        sooner = np.mean(runs["features"][:, 1] < runs["qlearning"][:, 1])
        for name, (stays, times) in ((name, run.T) for name, run in runs.items()):
            left = [f"{stays.mean():.2f}", f"{stays.max():.0f}", f"{100 * np.mean(stays <= SOON):.0f}"]
            ends = f"{100 * sooner:.0f}" if name == "features" else ""
            rows.append([f"{lift:g}", name, *left, f"{times.mean():.1f}", ends])
    head = ["lift, s", "planner", "segments before it leaves", "most", "at most 3, %", "mean time, s", "sooner, %"]
    put(table(head, rows), "planning.md", "slowdown")


def slowed(name: str, pocket: Pocket) -> tuple[float, float]:
    """Return how many segments a planner mills before it leaves its first side, and how long the pocket takes, s."""
    first = mill(pocket, planner(name, pocket))[0].cut.side
    slow = replace(pocket, true={"theta": {first: SLOWDOWN}})
    segments = mill(slow, planner(name, slow))
    stays = next((n for n, each in enumerate(segments) if each.cut.side != first), len(segments))
    return float(stays), total(segments)


def drawn(tables: int, rows: int, cols: int, feeds: str, lift: float = LIFT) -> Iterator[tuple[Pocket, float]]:
    rng = np.random.default_rng([rows, cols, len(feeds)])
    return (draw(rng, rows, cols, 2, feeds, lift) for _ in range(tables))


def gaps(name: str, pockets: list[tuple[Pocket, float]]) -> np.ndarray:
    return np.array([
        total(mill(pocket, planner(name, pocket, seed))) / best - 1.0 for seed, (pocket, best) in enumerate(pockets)
    ])  # fmt: skip


def _told(gaps: np.ndarray) -> list[str]:
    over = np.maximum(gaps, 0.0)
    return [f"{100 * np.mean(gaps < OPTIMAL):.1f}", f"{100 * over.mean():.3f}", f"{100 * over.max():.2f}"]


PARTS: dict[str, Callable[[], Any]] = {
    "two": two_directions,
    "four": four_directions,
    "slowdown": slowdown,
    "slow": lambda: put(slow_side(), "planning.md", "slow side"),
    "training": lambda: put(self_training(), "planning.md", "self-training"),
    "optimism": lambda: put(optimism(), "planning.md", "optimism"),
    "chapter7": lambda: put(chapter_7(), "planning.md", "chapter 7"),
}

if __name__ == "__main__":
    for part in words() or PARTS:
        PARTS[part]()
