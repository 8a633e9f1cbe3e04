"""The forces that explain a torque equally well: where six slabs |u - T f| <= r meet, edge by edge.

A slab is what one joint's friction range leaves of the forces, with a reach r of 1, or more where the range is widened.
The set is bounded wherever T (6, 3) has full rank; its extremes are at the ends of its edges, and the point nearest to
another one is inside, on a face or on an edge.
"""

import numpy as np

from rigkit.compiled import njit

JOINTS, PARTS = 6, 3
SLACK = 1e-10
"""Of a slab's half width, by which rounding may leave it."""
PARALLEL = 1e-10
"""Sine of an angle below which two faces make no edge."""

EDGE, POINT, WAY, HALF, BY_FIRST, BY_SECOND, CROSSED, GRAM = range(8)
"""Rows of `work` (13, 6): an edge's direction and a point of it; a column for each slab that cuts it; T T'."""
ROWS = GRAM + JOINTS


@njit(cache=True, nogil=True)
def is_inside(force: np.ndarray, middle: np.ndarray, slab: np.ndarray, margin: float = -SLACK) -> bool:
    """Whether a force (3,) is in all slabs `slab` (6, 3) of reach 1 about `middle` (6,), by a `margin`."""
    for j in range(JOINTS):
        off = middle[j] - slab[j, 0] * force[0] - slab[j, 1] * force[1] - slab[j, 2] * force[2]
        if not abs(off) <= 1.0 - margin:
            return False
    return True


@njit(cache=True, nogil=True)
def widen(force: np.ndarray, low: np.ndarray, high: np.ndarray) -> None:
    """Let the box from `low` to `high` (3,) hold a force (3,)."""
    for k in range(PARTS):
        low[k] = min(low[k], force[k])
        high[k] = max(high[k], force[k])


@njit(cache=True, nogil=True)
def distance(force: np.ndarray, goal: np.ndarray, weight: np.ndarray) -> float:
    """Return (f - goal)' weight (f - goal), `weight` (3, 3)."""
    total = 0.0
    for r in range(PARTS):
        for c in range(PARTS):
            total += (force[r] - goal[r]) * weight[r, c] * (force[c] - goal[c])
    return total


@njit(cache=True, nogil=True)
def search_edges(
    middle: np.ndarray,
    slab: np.ndarray,
    reach: np.ndarray,
    goal: np.ndarray,
    weight: np.ndarray,
    force: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    seek: bool,
    work: np.ndarray,
) -> None:
    """Widen `low` and `high` (3,) by all edges; with `seek`, let `force` be the point of them nearest to `goal`.

    `reach` (6,) is of the slabs; `force` comes as a point of the set.
    """
    edge, point, gram = work[EDGE], work[POINT][:PARTS], work[GRAM:]
    nearest = distance(force, goal, weight) if seek else 0.0
    _multiply(slab, gram)
    for i in range(JOINTS):
        for j in range(i + 1, JOINTS):
            square = gram[i, i] * gram[j, j] - gram[i, j] ** 2
            if square <= PARALLEL**2 * gram[i, i] * gram[j, j]:
                continue
            share = 1.0 / square
            _crossings(i, j, share, middle, slab, reach, work)
            for corner in range(4):
                at_i = reach[i] if corner % 2 else -reach[i]
                at_j = reach[j] if corner // 2 else -reach[j]
                start, end = _cut(at_i, at_j, work)
                if start > end:
                    continue
                _place(i, j, share * (middle[i] - at_i), share * (middle[j] - at_j), start, slab, work)
                widen(point, low, high)
                for k in range(PARTS):
                    point[k] += (end - start) * edge[k]
                widen(point, low, high)
                if seek:
                    _nearest_along(start - end, point, edge, goal, weight)
                    away = distance(point, goal, weight)
                    if away < nearest:
                        nearest = away
                        force[:] = point


@njit(cache=True, nogil=True)
def _multiply(slab: np.ndarray, gram: np.ndarray) -> None:
    """Fill T T' (6, 6)."""
    for i in range(JOINTS):
        for j in range(i, JOINTS):
            gram[i, j] = slab[i, 0] * slab[j, 0] + slab[i, 1] * slab[j, 1] + slab[i, 2] * slab[j, 2]
            gram[j, i] = gram[i, j]


@njit(cache=True, nogil=True)
def _crossings(
    i: int, j: int, share: float, middle: np.ndarray, slab: np.ndarray, reach: np.ndarray, work: np.ndarray
) -> None:
    """Fill the direction in which two faces meet, and for each other slab how it cuts their edge.

    Its way along the edge, half of it, and how that way moves with each face's place.  A slab along the edge has no
    such way: then what it leaves, and half its width.  `share` is 1 over the direction's square.
    """
    edge, gram = work[EDGE], work[GRAM:]
    for k in range(PARTS):
        a, b = (k + 1) % PARTS, (k + 2) % PARTS
        edge[k] = slab[i, a] * slab[j, b] - slab[i, b] * slab[j, a]
    row = 0
    for m in range(JOINTS):
        if m == i or m == j:
            continue
        slope = slab[m, 0] * edge[0] + slab[m, 1] * edge[1] + slab[m, 2] * edge[2]
        is_crossed = slope * slope * share > PARALLEL**2 * gram[m, m]
        scale = 1.0 / slope if is_crossed else 1.0
        by_first = scale * share * (gram[i, m] * gram[j, j] - gram[i, j] * gram[j, m])
        by_second = scale * share * (gram[j, m] * gram[i, i] - gram[i, j] * gram[i, m])
        work[WAY, row] = scale * middle[m] - middle[i] * by_first - middle[j] * by_second
        work[HALF, row] = abs(scale) * (reach[m] + SLACK)
        work[BY_FIRST, row], work[BY_SECOND, row] = by_first, by_second
        work[CROSSED, row] = 1.0 if is_crossed else 0.0
        row += 1


@njit(cache=True, nogil=True)
def _place(i: int, j: int, first: float, second: float, along: float, slab: np.ndarray, work: np.ndarray) -> None:
    """Fill the point of an edge, from how far its faces are and how far along it is."""
    edge, point = work[EDGE], work[POINT]
    for k in range(PARTS):
        a, b = (k + 1) % PARTS, (k + 2) % PARTS
        from_first = slab[j, a] * edge[b] - slab[j, b] * edge[a]
        from_second = edge[a] * slab[i, b] - edge[b] * slab[i, a]
        point[k] = first * from_first + second * from_second + along * edge[k]


@njit(cache=True, nogil=True)
def _cut(at_i: float, at_j: float, work: np.ndarray) -> tuple[float, float]:
    """Return from where to where an edge is in the set; the first number is larger where it is nowhere."""
    start, end = -np.inf, np.inf
    for row in range(JOINTS - 2):
        way = work[WAY, row] + at_i * work[BY_FIRST, row] + at_j * work[BY_SECOND, row]
        half = work[HALF, row]
        if work[CROSSED, row] != 0.0:
            start, end = max(start, way - half), min(end, way + half)
        elif not abs(way) <= half:
            return 1.0, 0.0
        if start > end:
            break
    return (start, end) if start > -np.inf else (1.0, 0.0)


@njit(cache=True, nogil=True)
def _nearest_along(back: float, point: np.ndarray, edge: np.ndarray, goal: np.ndarray, weight: np.ndarray) -> None:
    """Move `point` (3,), which is at the end of an edge, to where it is nearest to `goal`, by at least `back` <= 0."""
    along = square = 0.0
    for r in range(PARTS):
        for c in range(PARTS):
            along += edge[r] * weight[r, c] * (goal[c] - point[c])
            square += edge[r] * weight[r, c] * edge[c]
    move = min(max(along / square, back), 0.0)
    for k in range(PARTS):
        point[k] += move * edge[k]


@njit(cache=True, nogil=True)
def search_faces(
    middle: np.ndarray,
    slab: np.ndarray,
    goal: np.ndarray,
    inverse: np.ndarray,
    weight: np.ndarray,
    force: np.ndarray,
    work: np.ndarray,
) -> None:
    """Let `force` be the point of the set's faces nearest to `goal`, if nearer; `inverse` is that of `weight`."""
    pull, point = work[EDGE], work[POINT][:PARTS]
    nearest = distance(force, goal, weight)
    for i in range(JOINTS):
        off = middle[i]
        square = 0.0
        for r in range(PARTS):
            pull[r] = 0.0
            for c in range(PARTS):
                pull[r] += inverse[r, c] * slab[i, c]
            off -= slab[i, r] * goal[r]
            square += slab[i, r] * pull[r]
        if square <= 0.0:
            continue
        for sign in (-1.0, 1.0):
            for k in range(PARTS):
                point[k] = goal[k] + pull[k] * (off - sign) / square
            away = distance(point, goal, weight)
            if away < nearest and is_inside(point, middle, slab):
                nearest = away
                for k in range(PARTS):
                    force[k] = point[k]
