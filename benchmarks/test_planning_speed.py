"""How long a decision takes, on pockets of the size that the thesis mills.

`NUMBA_DISABLE_JIT=1` before the command runs the same in plain Python.
"""

from dataclasses import replace
from typing import Any

import pytest

from stagectl.planning.exact import Optimum
from stagectl.planning.milling import mill
from stagectl.planning.pocket import planner
from stagectl.planning.problem import Pocket, milling_types
from stagectl.planning.strips import costs, untouched


def _pocket(rows: int, tool: int, feeds: str) -> Pocket:
    hands = {"u": 0.9, "d": 1.1}
    rate = {
        name: int(name[1]) ** 0.7 * hands.get(name[-1], 1.0) * (1.0 + 0.1 * feeds.index(name[0]))
        for name in milling_types(tool, feeds)
    }
    return Pocket(rows, rows, tool, feeds, rate, t_acc=0.2, step=0.1, t_lift=0.5, v_lift=30.0)


@pytest.mark.parametrize(("rows", "tool", "feeds"), [(30, 3, "EW"), (18, 2, "EWNS"), (40, 2, "EWNS")])
def test_the_optimum(benchmark: Any, rows: int, tool: int, feeds: str) -> None:
    pocket = _pocket(rows, tool, feeds)
    cost = costs(pocket)
    benchmark(lambda: Optimum(cost).best(untouched(pocket)))


@pytest.mark.parametrize(
    ("name", "rows", "tool", "feeds"),
    [
        ("sequential", 30, 3, "EW"),
        ("qlearning", 18, 2, "EW"),
        ("features", 18, 2, "EWNS"),
        ("uncertain", 18, 2, "EWNS"),
    ],
)
def test_a_decision_after_a_duration_that_was_not_expected(
    benchmark: Any, name: str, rows: int, tool: int, feeds: str
) -> None:
    """The planner is told of its first segment, and chooses the second."""
    pocket = _pocket(rows, tool, feeds)
    first = mill(pocket, planner(name, pocket))[0]

    def told() -> tuple[tuple[Any, ...], dict[str, Any]]:
        made = planner(name, pocket)
        made.choose(first.standing)
        return (made,), {}

    def decide(made: Any) -> None:
        made.learn(replace(first, duration=1.4 * first.duration))
        made.choose(first.leaves())

    benchmark.pedantic(decide, setup=told, rounds=5)
