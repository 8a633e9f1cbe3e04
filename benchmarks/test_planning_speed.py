"""How long a plan takes, per decision, on pockets of the size that the thesis mills."""

from typing import Any

import pytest

from stagectl.planning.exact import Optimum
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
