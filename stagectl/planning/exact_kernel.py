"""The least time to the end of a pocket from every state of it: dynamic programming, compiled."""

import numpy as np

from rigkit.compiled import njit
from stagectl.planning.strip_kernel import (
    Uncut,
    across,
    along,
    breadth,
    ends_at_corner,
    is_inside,
    length,
    starts_at_corner,
    stop,
    without,
)

Strips = list[tuple[int, int, int, int]]
"""Way, k, and row and column where each starts."""


@njit(cache=True, nogil=True)
def intervals(cells: int) -> int:
    """Return how many intervals there are of so many cells."""
    return cells * (cells + 1) // 2


@njit(cache=True, nogil=True)
def _interval(low: int, high: int, cells: int) -> int:
    shorter = high - low - 1
    return shorter * (cells + 1) - intervals(shorter) + low


@njit(cache=True, nogil=True)
def _place(rectangle: Uncut, pocket: np.ndarray) -> int:
    """Return the row of `togo` that is a rectangle's."""
    rows = _interval(rectangle[0], rectangle[1], pocket[0].rows)
    if pocket[0].ways == 4:
        return rows
    return rows * intervals(pocket[0].cols) + _interval(rectangle[2], rectangle[3], pocket[0].cols)


@njit(cache=True, nogil=True)
def _ends(
    rectangle: Uncut, pocket: np.ndarray, rate: np.ndarray, togo: np.ndarray, times: np.ndarray, strips: Strips
) -> int:
    """List the legal strips, soonest at the end of the pocket first, and return how many there are.

    `times` are from the start of a strip to the end of the pocket, `strips` way, k, and row and column where it starts.
    """
    count = 0
    for way in range(pocket[0].ways):
        at, broad, cells = along(way, rectangle, pocket)[0], breadth(way, rectangle), length(way, rectangle)
        for k in range(1, min(pocket[0].tool, broad) + 1):
            beside = across(way, k, rectangle, pocket)
            if not is_inside(way, beside, pocket):
                continue
            time = pocket[0].begin + rate[way, k - 1] * cells
            if k < broad:
                time += togo[_place(without(way, k, rectangle), pocket), way]
            here = count
            while here > 0 and times[here - 1] > time:
                times[here] = times[here - 1]
                strips[here] = strips[here - 1]
                here -= 1
            times[here] = time
            strips[here] = (way, k, at, beside) if way & 4 else (way, k, beside, at)
            count += 1
    return count


@njit(cache=True, nogil=True)
def _least(
    last: int, rectangle: Uncut, pocket: np.ndarray, moves: np.ndarray, times: np.ndarray, strips: Strips, count: int
) -> tuple[float, int]:
    """Return the least time to the end after way `last`, -1 for none, and which strip it begins with."""
    if last < 0:
        return times[0], 0
    row, col = stop(last, rectangle, pocket)
    corner = ends_at_corner(last)
    best, which = np.inf, -1
    for n in range(count):
        if times[n] > best:
            break
        way, _, from_row, from_col = strips[n]
        lifted = 1 if starts_at_corner(way) != corner else 0
        time = times[n] + moves[lifted, abs(from_row - row), abs(from_col - col)]
        if time < best or (time == best and lifted == 0):
            best, which = time, n
    return best, which


@njit(cache=True, nogil=True)
def fill(pocket: np.ndarray, rate: np.ndarray, moves: np.ndarray, togo: np.ndarray) -> None:
    """Set the least time to the end, by rectangle and last way."""
    times, strips = np.empty(rate.size), [(0, 0, 0, 0)] * rate.size
    rows, cols = pocket[0].rows, pocket[0].cols
    narrowest = cols if pocket[0].ways == 4 else 1
    for height in range(1, rows + 1):
        for width in range(narrowest, cols + 1):
            for north in range(rows - height + 1):
                for west in range(cols - width + 1):
                    rectangle = (north, north + height, west, west + width)
                    count = _ends(rectangle, pocket, rate, togo, times, strips)
                    at = _place(rectangle, pocket)
                    for last in range(pocket[0].ways):
                        togo[at, last] = _least(last, rectangle, pocket, moves, times, strips, count)[0]


@njit(cache=True, nogil=True)
def best(
    last: int, rectangle: Uncut, pocket: np.ndarray, rate: np.ndarray, moves: np.ndarray, togo: np.ndarray
) -> tuple[float, int, int]:
    """Return the least time to the end from a state, and the way and k of the strip that it begins with."""
    times, strips = np.empty(rate.size), [(0, 0, 0, 0)] * rate.size
    count = _ends(rectangle, pocket, rate, togo, times, strips)
    time, which = _least(last, rectangle, pocket, moves, times, strips, count)
    return time, strips[which][0], strips[which][1]
