"""Chapter 7's rule: the next strip by its time per area there and back, and the corner to begin at, compiled."""

import numpy as np

from rigkit.compiled import njit
from stagectl.planning.strip_kernel import Uncut, breadth, is_legal, length, time_of, without

TWO_DIRECTIONS = 4
"""Ways: strips off the north and the south, fed to the east and the west."""
SMALLEST = 1e-9
"""A difference, of a cost, that is none."""


@njit(cache=True, nogil=True)
def _back(
    way: int, rectangle: Uncut, pocket: np.ndarray, rate: np.ndarray, moves: np.ndarray, extra: np.ndarray
) -> float:
    """Return the least cost per cell of a strip back after `way`, (7.31)."""
    least = np.inf
    for k in range(1, pocket[0].tool + 1):
        if is_legal(way ^ 1, k, rectangle, pocket):
            time = time_of(way ^ 1, k, way, rectangle, pocket, rate, moves)
            least = min(least, time / (length(way, rectangle) * k) + extra[way ^ 1, k - 1])
    return least


@njit(cache=True, nogil=True)
def _strip(
    way: int, last: int, rectangle: Uncut, pocket: np.ndarray, rate: np.ndarray, moves: np.ndarray, extra: np.ndarray
) -> tuple[int, bool]:
    """Return k by (7.34), and whether the tool is lifted back after it; 0 where no strip is legal."""
    best, best_k, is_lifted_back = np.inf, 0, False
    cells = length(way, rectangle)
    for k in range(1, pocket[0].tool + 1):
        if not is_legal(way, k, rectangle, pocket):
            continue
        out = time_of(way, k, last, rectangle, pocket, rate, moves) / (cells * k) + extra[way, k - 1]
        both, one = out, np.inf
        if k < breadth(way, rectangle):
            rest = without(way, k, rectangle)
            both = (out + _back(way, rest, pocket, rate, moves, extra)) / 2.0  # (7.29)
            one = out + moves[1, k, cells] / (cells * k)  # (7.32), (7.33)
        if min(both, one) < best:
            best, best_k, is_lifted_back = min(both, one), k, one < both
    return best_k, is_lifted_back


@njit(cache=True, nogil=True)
def _whole(
    way: int, last: int, rectangle: Uncut, pocket: np.ndarray, rate: np.ndarray, moves: np.ndarray, extra: np.ndarray
) -> tuple[float, int]:
    """Return the cost of all that is left when the next strip goes `way`, and its k."""
    first, cost = 0, 0.0
    while rectangle[0] < rectangle[1]:
        k, is_lifted_back = _strip(way, last, rectangle, pocket, rate, moves, extra)
        if k == 0:
            return np.inf, 0
        first = first or k
        area = k * length(way, rectangle)
        cost += time_of(way, k, last, rectangle, pocket, rate, moves) + area * extra[way, k - 1]
        rectangle = without(way, k, rectangle)
        last, way = way, way if is_lifted_back else way ^ 1
    return cost, first


@njit(cache=True, nogil=True)
def decide(
    last: int, rectangle: Uncut, pocket: np.ndarray, rate: np.ndarray, moves: np.ndarray, extra: np.ndarray
) -> tuple[int, int]:
    """Return way and k of the next strip: off the corner from which all that is left costs least."""
    best, best_way, best_k = np.inf, -1, 0
    first = last ^ 1 if last >= 0 else TWO_DIRECTIONS - 1  # where the tool stands, which wins where all is equal
    for turn in range(TWO_DIRECTIONS):
        cost, k = _whole(first ^ turn, last, rectangle, pocket, rate, moves, extra)
        if cost < best - SMALLEST * abs(best) or best_k == 0:
            best, best_way, best_k = cost, first ^ turn, k
    return best_way, best_k
