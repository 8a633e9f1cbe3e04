"""Pockets for the tests: the worked example, figure 8.8, random ones, and every path of a small one."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from stagectl.planning.exact import least_time
from stagectl.planning.pocket import check, plan
from stagectl.planning.problem import Pocket, milling_types

EXAMPLE: dict[str, Any] = {
    "rows": 30, "cols": 30, "G": 3, "feeds": "EW", "closed": True,
    "rate": {"E3": 0.075, "E2u": 0.0484, "E1u": 0.0442, "E2d": 0.054, "E1d": 0.0358,
             "W3": 0.0846, "W2u": 0.0652, "W1u": 0.037, "W2d": 0.0592, "W1d": 0.0368},
    "t_acc": 0, "step": 0, "t_lift": 0, "v_lift": 50, "theta": {}, "true": {},
}  # fmt: skip
"""Chapter 7's Experiment 1: the optimum is 23.80 s."""


def figure_8_8(begin: float) -> Pocket:
    """10 x 20: feeding the short way is faster a cell, and has twice as many segments; `begin` is s a segment."""
    rate = {f"{feed}{k}": 0.6697 if feed in "EW" else 0.7003 for feed in "EWNS" for k in ("2", "1u", "1d")}
    return Pocket(20, 10, 2, "EWNS", rate, t_acc=begin)


def random_pocket(rng: np.random.Generator, rows: int, cols: int, tool: int, feeds: str, closed: bool) -> Pocket:
    """Every cost drawn, so that no two moves cost the same; half of the pockets have a slow side."""
    rate = {name: int(name[1]) ** 0.7 * rng.uniform(0.5, 1.5) for name in milling_types(tool, feeds)}
    theta = {"N": rng.uniform(0.5, 2.0)} if rng.random() < 0.5 else {}
    lifts = {"t_lift": rng.uniform(0.0, 2.0), "v_lift": rng.uniform(1.0, 9.0) if rng.random() < 0.7 else None}
    return Pocket(
        rows, cols, tool, feeds, rate, closed, rng.uniform(0.0, 1.0), rng.uniform(0.0, 0.3), **lifts, theta=theta
    )


def check_random_paths(planner: str, rng: np.random.Generator, rows: int) -> None:
    """Demand that a planner's paths are legal, complete and not below the optimum, on pockets of all kinds."""
    for seed, (tool, feeds, closed) in enumerate(
        (tool, feeds, closed) for tool in (2, 3) for feeds in ("EW", "EWNS") for closed in (True, False)
    ):
        pocket = random_pocket(rng, rows, 7, tool, feeds, closed)
        verdict = check(pocket, plan(pocket, planner, seed))
        assert verdict.complete
        assert verdict.total >= least_time(pocket) - 1e-9


Uncut = tuple[int, int, int, int]
Tool = tuple[int, int, str]
"""Row, column and corner, such as NE."""


def least_by_brute_force(pocket: Pocket) -> float:
    """Go through every path of a pocket, but for those that already cost more than the best."""
    best = [np.inf]
    _search(pocket, (0, pocket.rows, 0, pocket.cols), None, 0.0, best)
    return best[0]


def _search(pocket: Pocket, uncut: Uncut, tool: Tool | None, spent: float, best: list[float]) -> None:
    if spent >= best[0]:
        return
    if uncut[0] == uncut[1] or uncut[2] == uncut[3]:
        best[0] = spent
        return
    for name, side, place, end, rest, cells in _strips(pocket, uncut):
        time = pocket.t_acc + pocket.rate[name] * pocket.theta.get(side, 1.0) * cells
        feed = name[0]
        starts = _corner(side, {"E": "W", "W": "E", "N": "S", "S": "N"}[feed])
        if tool is not None:
            far = float(np.hypot(place[0] - tool[0], place[1] - tool[1]))
            lifted = pocket.t_lift + (far / pocket.v_lift if pocket.v_lift else 0.0)
            time += pocket.step * far if tool[2] == starts else lifted
        _search(pocket, rest, (*end, _corner(side, feed)), spent + time, best)


def _corner(one: str, other: str) -> str:
    return one + other if one in "NS" else other + one


def _strips(pocket: Pocket, uncut: Uncut) -> Iterator[tuple[str, str, tuple[int, int], tuple[int, int], Uncut, int]]:
    """Write out, side by side, all that `strip_kernel` folds into bits."""
    top, bottom, left, right = uncut
    G = pocket.G  # noqa: N806
    for k in range(1, G + 1):
        hands = ("", "") if k == G else ("d", "u")
        if k <= bottom - top:
            west, east = left, right - G  # where the footprint begins and ends
            if pocket.closed:
                west, east = min(west, pocket.cols - G), max(east, 0)
            for side, row, rest in (
                ("N", top + k - G, (top + k, *uncut[1:])),
                ("S", bottom - k, (top, bottom - k, left, right)),
            ):
                hand_e, hand_w = hands if side == "N" else hands[::-1]
                if pocket.closed and not 0 <= row <= pocket.rows - G:
                    continue
                yield f"E{k}{hand_e}", side, (row, west), (row, max(east, west)), rest, right - left
                yield f"W{k}{hand_w}", side, (row, east), (row, min(east, west)), rest, right - left
        if k <= right - left and "N" in pocket.feeds:
            north, south = top, bottom - G
            if pocket.closed:
                north, south = min(north, pocket.rows - G), max(south, 0)
            for side, col, rest in (
                ("W", left + k - G, (top, bottom, left + k, right)),
                ("E", right - k, (top, bottom, left, right - k)),
            ):
                hand_n, hand_s = hands if side == "W" else hands[::-1]
                if pocket.closed and not 0 <= col <= pocket.cols - G:
                    continue
                yield f"S{k}{hand_s}", side, (north, col), (max(north, south), col), rest, bottom - top
                yield f"N{k}{hand_n}", side, (south, col), (min(north, south), col), rest, bottom - top
