"""The least time of a pocket by our dynamic programming, beside graph searches and an integer program of others.

All are given the same states and moves.  The graph of a pocket is made by `stagectl.planning.strips`, and its making is
not counted; what is counted of ours is everything.
"""

from collections.abc import Callable
from importlib.util import find_spec
from time import process_time

import numpy as np
from scipy.optimize import LinearConstraint, milp
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra

from benchmarks.planning_pockets import LIFT, draw
from stagectl.planning.exact import least_time
from stagectl.planning.milling import mill, total
from stagectl.planning.pocket import planner
from stagectl.planning.problem import Pocket
from stagectl.planning.strips import Standing, after, costs, cutting, legal, moving, untouched

SIZES = ((12, 12, "EW"), (30, 30, "EW"), (8, 8, "EWNS"), (12, 12, "EWNS"))
HEAD = ("pocket", "states, moves", "who", "processor, ms", "least time, s")
LEARNED = ((13, "EW", ("sequential", "qlearning")), (12, "EWNS", ("qlearning", "features", "uncertain", "exact")))
TABLES = 40
LEARNED_HEAD = ("pocket", "planner", "optimal, %", "mean gap, %", "worst, %")
SMALLEST = 1e-7
"""%: more is not optimal."""
MOST = 100_000
"""Moves of an integer program; with 234 744 it took 32 s."""


def graph(pocket: Pocket) -> tuple[csr_array, int]:
    """Return the moves between states as a sparse matrix, s, and the number of the end; the beginning is 0."""
    cost, begin = costs(pocket), untouched(pocket)
    number: dict[Standing | None, int] = {begin: 0, None: 1}
    source, target, weight, waiting = [], [], [], [begin]
    while waiting:
        here = waiting.pop()
        for cut in legal(here, cost):
            there = after(cut, here)
            key = None if there.is_done else there
            if key is not None and key not in number:
                number[key] = len(number)
                waiting.append(there)
            source.append(number[here])
            target.append(number[key])
            weight.append(moving(cut, here, cost) + cutting(cut, here, cost))
    least = _least_of_parallel(np.array(source), np.array(target), np.array(weight))
    return csr_array(coo_array((least[2], (least[0], least[1])), shape=(len(number), len(number)))), 1


def by_networkx(moves: csr_array, end: int) -> Callable[[], float]:
    """Return what finds the least time by Dijkstra's algorithm in networkx, s; its graph is made already."""
    import networkx

    made = networkx.from_scipy_sparse_array(moves, create_using=networkx.DiGraph)
    return lambda: float(networkx.dijkstra_path_length(made, 0, end))


def by_scipy(moves: csr_array, end: int) -> float:
    """Return the least time by Dijkstra's algorithm in scipy, s."""
    return float(dijkstra(moves, indices=0)[end])


def by_integers(moves: csr_array, end: int) -> float:
    """Return the least time as an integer program by HiGHS, s: one unit flows from the beginning to the end."""
    arcs = coo_array(moves)
    count = len(arcs.data)
    each = np.arange(count)
    flow = coo_array((np.ones(count), (arcs.row, each)), shape=(moves.shape[0], count))
    flow = csr_array(flow - coo_array((np.ones(count), (arcs.col, each)), shape=(moves.shape[0], count)))
    balance = np.zeros(moves.shape[0])
    balance[0], balance[end] = 1.0, -1.0
    return float(milp(arcs.data, constraints=LinearConstraint(flow, balance, balance), integrality=np.ones(count)).fun)


def rows() -> list[list[str]]:
    """Return a row for each size and each way."""
    rng = np.random.default_rng(7)
    drawn = [(draw(rng, height, width, 2, feeds, LIFT)[0], f"{height} x {width}") for height, width, feeds in SIZES]
    return [row for pocket, name in drawn for row in _of_pocket(pocket, name)]


def _of_pocket(pocket: Pocket, name: str) -> list[list[str]]:
    moves, end = graph(pocket)
    head = [f"{name}, {len(pocket.feeds)} directions", f"{moves.shape[0]}, {moves.nnz}"]
    least_time(pocket)  # compiled
    ways: dict[str, Callable[[], float] | None] = {
        "ours, dynamic programming": lambda: least_time(pocket),
        "scipy, Dijkstra": lambda: by_scipy(moves, end),
        "networkx, Dijkstra": by_networkx(moves, end) if find_spec("networkx") else None,
    }
    told = [[*head, who, *_taken(way)] for who, way in ways.items()]
    whole = _taken(lambda: by_integers(moves, end), 1) if moves.nnz < MOST else ["not run: half a minute", ""]
    return [*told, [*head, "scipy's HiGHS, integer program", *whole]]


def learned() -> list[list[str]]:
    """Return a row for each planner: how far it is from the optimum where its rates are right."""
    told = []
    for size, feeds, names in LEARNED:
        rng = np.random.default_rng([size, len(feeds), 9000])
        pockets = [draw(rng, size, size, 2, feeds, LIFT) for _ in range(TABLES)]
        for name in names:
            times = [total(mill(each, planner(name, each, n))) for n, (each, _) in enumerate(pockets)]
            over = 100 * np.maximum(np.array(times) / [best for _, best in pockets] - 1.0, 0.0)
            figures = f"{100 * np.mean(over < SMALLEST):.0f}", f"{over.mean():.2f}", f"{over.max():.1f}"
            told.append([f"{size} x {size}, {len(feeds)} directions", f"`{name}`", *figures])
    return told


def _taken(way: Callable[[], float] | None, rounds: int = 5) -> list[str]:
    if way is None:
        return ["not installed", ""]
    best, found = np.inf, np.nan
    for _ in range(rounds):
        begun = process_time()
        found = way()
        best = min(best, process_time() - begun)
    return [f"{1e3 * best:.2f}", f"{found:.3f}"]


def _least_of_parallel(source: np.ndarray, target: np.ndarray, weight: np.ndarray) -> tuple[np.ndarray, ...]:
    order = np.lexsort((weight, target, source))
    source, target, weight = source[order], target[order], weight[order]
    first = np.ones(len(source), bool)
    first[1:] = (source[1:] != source[:-1]) | (target[1:] != target[:-1])
    return source[first], target[first], weight[first]
