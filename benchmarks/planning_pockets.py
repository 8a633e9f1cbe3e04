"""Random pockets for comparing planners: seeded tables whose optimum mixes strips of several widths."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from stagectl.planning.exact import ExactPlanner
from stagectl.planning.milling import mill, total
from stagectl.planning.problem import Pocket, milling_types

TIMES: Mapping[str, Any] = {"t_acc": 0.2, "step": 0.05, "v_lift": 10.0}
"""s a segment, s per cell, cells/s; a slot takes 0.9 to 1.44 s per cell."""
LIFT = 1.0
"""s."""
FEWEST_PARTIAL = 3
SLOT, SPREAD, SAVED = 0.9, 1.6, 0.8
"""s per cell; a type takes SLOT (k / G)^SAVED, times 1 to SPREAD."""


def draw(
    rng: np.random.Generator, rows: int, cols: int, tool: int, feeds: str, lift: float = LIFT
) -> tuple[Pocket, float]:
    """Return a pocket whose optimum has at least three strips narrower than the tool, and its time; both in s."""
    while True:
        rate = {
            name: float(SLOT * (int(name[1]) / tool) ** SAVED * rng.uniform(1.0, SPREAD))
            for name in milling_types(tool, feeds)
        }
        pocket = Pocket(rows, cols, tool, feeds, rate, t_lift=lift, **TIMES)
        best = mill(pocket, ExactPlanner(pocket))
        if sum(each.cut.k < tool for each in best) >= FEWEST_PARTIAL:
            return pocket, total(best)
