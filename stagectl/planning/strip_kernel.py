"""Where strips lie and the tool stands: the planners' geometry, compiled.

A way is a side and a feed, as one number: 4 for a feed to the north or south, + 2 for a strip off the south or east
side, + 1 for a feed to the west or north.  A rectangle is north, south, west, east: of the rows north ... south - 1.
"""

import numpy as np

from rigkit.compiled import njit

POCKET = np.dtype(
    [
        # cells
        ("rows", "i8"),
        ("cols", "i8"),
        ("tool", "i8"),
        ("closed", "?"),  # whether there are walls
        ("ways", "i8"),  # 4 or 8
        ("begin", "f8"),  # s a segment
    ],
    align=True,
)
"""Kernels take an array of one."""

Uncut = tuple[int, ...]
"""North, south, west, east."""


@njit(cache=True, nogil=True)
def starts_at_corner(way: int) -> int:
    """Return the corner of the uncut rectangle where a way starts: 1 for east, + 2 for south."""
    along, across = way & 1, (way >> 1) & 1
    return across + 2 * along if way & 4 else along + 2 * across


@njit(cache=True, nogil=True)
def ends_at_corner(way: int) -> int:
    """Return the corner where a way ends."""
    return starts_at_corner(way ^ 1)


@njit(cache=True, nogil=True)
def length(way: int, rectangle: Uncut) -> int:
    """Return how far a way feeds, cells."""
    return rectangle[1] - rectangle[0] if way & 4 else rectangle[3] - rectangle[2]


@njit(cache=True, nogil=True)
def breadth(way: int, rectangle: Uncut) -> int:
    """Return how many rows or columns a way can mill off, cells."""
    return rectangle[3] - rectangle[2] if way & 4 else rectangle[1] - rectangle[0]


@njit(cache=True, nogil=True)
def along(way: int, rectangle: Uncut, pocket: np.ndarray) -> tuple[int, int]:
    """Return where along its feed the footprint starts and ends: over the strip, and within the walls."""
    if way & 4:
        low, high, end = rectangle[0], rectangle[1] - pocket[0].tool, pocket[0].rows - pocket[0].tool
    else:
        low, high, end = rectangle[2], rectangle[3] - pocket[0].tool, pocket[0].cols - pocket[0].tool
    if pocket[0].closed:
        low, high = min(low, end), max(high, 0)
    return (high, min(high, low)) if way & 1 else (low, max(low, high))


@njit(cache=True, nogil=True)
def across(way: int, k: int, rectangle: Uncut, pocket: np.ndarray) -> int:
    """Return where across its feed the footprint lies over a strip of k off `rectangle`."""
    if way & 2:
        return (rectangle[3] if way & 4 else rectangle[1]) - k
    return int((rectangle[2] if way & 4 else rectangle[0]) + k - pocket[0].tool)


@njit(cache=True, nogil=True)
def is_inside(way: int, place: int, pocket: np.ndarray) -> bool:
    """Whether a footprint at `place` across its feed keeps within the walls, if there are any."""
    return bool(not pocket[0].closed or 0 <= place <= (pocket[0].cols if way & 4 else pocket[0].rows) - pocket[0].tool)


@njit(cache=True, nogil=True)
def is_legal(way: int, k: int, rectangle: Uncut, pocket: np.ndarray) -> bool:
    """Whether a strip of k is there to be milled, and the footprint keeps within the walls."""
    return k <= breadth(way, rectangle) and is_inside(way, across(way, k, rectangle, pocket), pocket)


@njit(cache=True, nogil=True)
def start(way: int, k: int, rectangle: Uncut, pocket: np.ndarray) -> tuple[int, int]:
    """Return row and column of the footprint where a strip of k off `rectangle` starts."""
    at, beside = along(way, rectangle, pocket)[0], across(way, k, rectangle, pocket)
    return (at, beside) if way & 4 else (beside, at)


@njit(cache=True, nogil=True)
def stop(way: int, rectangle: Uncut, pocket: np.ndarray) -> tuple[int, int]:
    """Return row and column of the footprint after a strip, with what that left uncut as `rectangle`."""
    at, beside = along(way, rectangle, pocket)[1], across(way, 0, rectangle, pocket)
    return (at, beside) if way & 4 else (beside, at)


@njit(cache=True, nogil=True)
def without(way: int, k: int, rectangle: Uncut) -> Uncut:
    """Return what is left of `rectangle`."""
    north, south, west, east = rectangle
    if way & 4:
        return (north, south, west, east - k) if way & 2 else (north, south, west + k, east)
    return (north, south - k, west, east) if way & 2 else (north + k, south, west, east)


@njit(cache=True, nogil=True)
def time_of(
    way: int, k: int, last: int, rectangle: Uncut, pocket: np.ndarray, rate: np.ndarray, moves: np.ndarray
) -> float:
    """Return the time of a strip and of the move to it from where way `last` left the tool, -1 for none; s."""
    time: float = pocket[0].begin + rate[way, k - 1] * length(way, rectangle)
    if last < 0:
        return time
    row, col = stop(last, rectangle, pocket)
    from_row, from_col = start(way, k, rectangle, pocket)
    lifted = 1 if starts_at_corner(way) != ends_at_corner(last) else 0
    return time + float(moves[lifted, abs(from_row - row), abs(from_col - col)])
