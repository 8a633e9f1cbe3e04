"""Where strips lie and the tool stands: the planners' geometry, compiled.

A way is a side and a feed, as one number: 4 for a feed to the north or south, + 2 for a strip off the south or east
side, + 1 for a feed to the west or north.  A rectangle is north, south, west, east: of the rows north ... south - 1.
"""

from numba import njit

ROWS, COLS, TOOL, CLOSED, WAYS = range(5)
"""Of `size`: cells, cells, cells, 0 or 1, and 4 ways or 8."""


@njit(cache=True, nogil=True)
def starts_at_corner(way):  # type: ignore[no-untyped-def]
    """Return the corner of the uncut rectangle where a way starts: 1 for east, + 2 for south."""
    along, across = way & 1, (way >> 1) & 1
    return across + 2 * along if way & 4 else along + 2 * across


@njit(cache=True, nogil=True)
def ends_at_corner(way):  # type: ignore[no-untyped-def]
    """Return the corner where a way ends."""
    return starts_at_corner(way ^ 1)


@njit(cache=True, nogil=True)
def length(way, rectangle):  # type: ignore[no-untyped-def]
    """Return how far a way feeds, cells."""
    return rectangle[1] - rectangle[0] if way & 4 else rectangle[3] - rectangle[2]


@njit(cache=True, nogil=True)
def breadth(way, rectangle):  # type: ignore[no-untyped-def]
    """Return how many rows or columns a way can mill off, cells."""
    return rectangle[3] - rectangle[2] if way & 4 else rectangle[1] - rectangle[0]


@njit(cache=True, nogil=True)
def along(way, rectangle, size):  # type: ignore[no-untyped-def]
    """Return where along its feed the footprint starts and ends: over the strip, and within the walls."""
    if way & 4:
        low, high, end = rectangle[0], rectangle[1] - size[TOOL], size[ROWS] - size[TOOL]
    else:
        low, high, end = rectangle[2], rectangle[3] - size[TOOL], size[COLS] - size[TOOL]
    if size[CLOSED]:
        low, high = min(low, end), max(high, 0)
    return (high, min(high, low)) if way & 1 else (low, max(low, high))


@njit(cache=True, nogil=True)
def across(way, k, rectangle, size):  # type: ignore[no-untyped-def]
    """Return where across its feed the footprint lies over a strip of k off `rectangle`."""
    if way & 2:
        return (rectangle[3] if way & 4 else rectangle[1]) - k
    return (rectangle[2] if way & 4 else rectangle[0]) + k - size[TOOL]


@njit(cache=True, nogil=True)
def is_inside(way, place, size):  # type: ignore[no-untyped-def]
    """Whether a footprint at `place` across its feed keeps within the walls, if there are any."""
    return not size[CLOSED] or 0 <= place <= (size[COLS] if way & 4 else size[ROWS]) - size[TOOL]


@njit(cache=True, nogil=True)
def is_legal(way, k, rectangle, size):  # type: ignore[no-untyped-def]
    """Whether a strip of k is there to be milled, and the footprint keeps within the walls."""
    return k <= breadth(way, rectangle) and is_inside(way, across(way, k, rectangle, size), size)


@njit(cache=True, nogil=True)
def start(way, k, rectangle, size):  # type: ignore[no-untyped-def]
    """Return row and column of the footprint where a strip of k off `rectangle` starts."""
    at, beside = along(way, rectangle, size)[0], across(way, k, rectangle, size)
    return (at, beside) if way & 4 else (beside, at)


@njit(cache=True, nogil=True)
def stop(way, rectangle, size):  # type: ignore[no-untyped-def]
    """Return row and column of the footprint after a strip, with what that left uncut as `rectangle`."""
    at, beside = along(way, rectangle, size)[1], across(way, 0, rectangle, size)
    return (at, beside) if way & 4 else (beside, at)


@njit(cache=True, nogil=True)
def without(way, k, rectangle):  # type: ignore[no-untyped-def]
    """Return what is left of `rectangle`."""
    north, south, west, east = rectangle
    if way & 4:
        return (north, south, west, east - k) if way & 2 else (north, south, west + k, east)
    return (north, south - k, west, east) if way & 2 else (north + k, south, west, east)


@njit(cache=True, nogil=True)
def time_of(way, k, last, rectangle, size, rate, begin, moves):  # type: ignore[no-untyped-def]
    """Return the time of a strip and of the move to it from where way `last` left the tool, -1 for none; s."""
    time = begin + rate[way, k - 1] * length(way, rectangle)
    if last < 0:
        return time
    row, col = stop(last, rectangle, size)
    from_row, from_col = start(way, k, rectangle, size)
    lifted = 1 if starts_at_corner(way) != ends_at_corner(last) else 0
    return time + moves[lifted, abs(from_row - row), abs(from_col - col)]
