"""Between which bounds forces in six slabs |u - T f| <= r are: six linear programs by the dual simplex method.

Three independent slabs have a corner in each direction, so that any three of them are a start; the slab that a corner
breaks most takes the place of one of the three, until no slab is broken.
"""

import numpy as np

from rigkit.compiled import njit

JOINTS, PARTS = 6, 3
FOUND, EMPTY, LOST = range(3)
"""Bounds; no force is in all slabs; rounding went in circles."""
MOST_ROUNDS = 30
SLACK = 1e-10
"""Of a friction range's half width, by which rounding may leave a slab."""
NOTHING = 1e-10
"""Of the largest share that one of three slabs has in a fourth: a share that is rounding."""

"""Of `work` (3, 6)."""


@njit(cache=True, nogil=True)
def search_box(
    middle: np.ndarray, slab: np.ndarray, reach: np.ndarray, low: np.ndarray, high: np.ndarray, work: np.ndarray
) -> int:
    """Fill `low` and `high` (3,) over all forces in the slabs `slab` (6, 3) of `reach` (6,) about `middle` (6,).

    The slabs have rank three.  Return `FOUND`, `EMPTY` or `LOST`.
    """
    a, b, c = _start(slab, work)
    for part in range(PARTS):
        for sign in (1.0, -1.0):
            found, extreme, a, b, c = _climb(part, sign, a, b, c, middle, slab, reach)
            if found != FOUND:
                return found
            if sign > 0.0:
                high[part] = extreme
            else:
                low[part] = extreme
    return FOUND


@njit(cache=True, nogil=True)
def _start(slab: np.ndarray, left: np.ndarray) -> tuple[int, int, int]:
    """Return three slabs that are far from parallel, by Gram-Schmidt with pivots; `left` (3, 6) is room."""
    for j in range(JOINTS):
        for k in range(PARTS):
            left[k, j] = slab[j, k]
    first, second = 0, 0
    for turn in range(PARTS):
        best, most = 0, -1.0
        for j in range(JOINTS):
            square = left[0, j] ** 2 + left[1, j] ** 2 + left[2, j] ** 2
            if square > most and not (turn > 0 and j == first) and not (turn > 1 and j == second):
                best, most = j, square
        if turn == PARTS - 1 or most == 0.0:
            break
        x, y, z = left[0, best], left[1, best], left[2, best]
        for j in range(JOINTS):
            along = (left[0, j] * x + left[1, j] * y + left[2, j] * z) / most
            left[0, j] -= along * x
            left[1, j] -= along * y
            left[2, j] -= along * z
        first, second = (best, second) if turn == 0 else (first, best)
    return first, second, best


@njit(cache=True, nogil=True)
def _climb(
    part: int, sign: float, a: int, b: int, c: int, middle: np.ndarray, slab: np.ndarray, reach: np.ndarray
) -> tuple[int, float, int, int, int]:
    """Go from slabs a, b, c to those whose corner is furthest along a part of the force, up (`sign` 1) or down (-1).

    Return what was found, how far that is, N, and the three.
    """
    u, v, w = part, (part + 1) % PARTS, (part + 2) % PARTS
    for _ in range(MOST_ROUNDS):
        ax, ay, az = slab[a, u], slab[a, v], slab[a, w]
        bx, by, bz = slab[b, u], slab[b, v], slab[b, w]
        cx, cy, cz = slab[c, u], slab[c, v], slab[c, w]
        px, py, pz = by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx
        qx, qy, qz = cy * az - cz * ay, cz * ax - cx * az, cx * ay - cy * ax
        rx, ry, rz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        determinant = ax * px + ay * py + az * pz
        if determinant == 0.0:
            break
        scale = 1.0 / determinant
        up = sign if scale > 0.0 else -sign
        side_a, side_b, side_c = np.copysign(1.0, up * px), np.copysign(1.0, up * qx), np.copysign(1.0, up * rx)
        at_a = scale * (middle[a] + side_a * reach[a])
        at_b = scale * (middle[b] + side_b * reach[b])
        at_c = scale * (middle[c] + side_c * reach[c])
        x, y, z = (
            px * at_a + qx * at_b + rx * at_c,
            py * at_a + qy * at_b + ry * at_c,
            pz * at_a + qz * at_b + rz * at_c,
        )
        broken, way = _broken(x, y, z, part, a, b, c, middle, slab, reach)
        if broken < 0:
            return FOUND, x, a, b, c
        way = np.copysign(1.0, way * scale)
        tx, ty, tz = way * slab[broken, u], way * slab[broken, v], way * slab[broken, w]
        share_a = side_a * (tx * px + ty * py + tz * pz)
        share_b = side_b * (tx * qx + ty * qy + tz * qz)
        share_c = side_c * (tx * rx + ty * ry + tz * rz)
        place = _leaves(share_a, share_b, share_c, abs(px), abs(qx), abs(rx))
        if place < 0:
            return EMPTY, x, a, b, c
        a, b, c = broken if place == 0 else a, broken if place == 1 else b, broken if place == 2 else c
    return LOST, np.nan, a, b, c


@njit(cache=True, nogil=True)
def _broken(
    x: float, y: float, z: float, part: int, a: int, b: int, c: int,
    middle: np.ndarray, slab: np.ndarray, reach: np.ndarray,
) -> tuple[int, float]:  # fmt: skip
    """Return which slab but a, b, c a corner is furthest outside of, -1 for none, and how far it is from its middle.

    The corner's parts x, y, z begin with `part`.
    """
    u, v, w = part, (part + 1) % PARTS, (part + 2) % PARTS
    broken, most, way = -1, SLACK, 0.0
    for j in range(JOINTS):
        off = slab[j, u] * x + slab[j, v] * y + slab[j, w] * z - middle[j]
        if abs(off) - reach[j] > most and j != a and j != b and j != c:
            broken, most, way = j, abs(off) - reach[j], off
    return broken, way


@njit(cache=True, nogil=True)
def _leaves(share_a: float, share_b: float, share_c: float, price_a: float, price_b: float, price_c: float) -> int:
    """Return which of three slabs makes place for a broken one, of the least price over share; -1 for none."""
    least = NOTHING * max(abs(share_a), abs(share_b), abs(share_c))
    place, price, share = -1, 1.0, 0.0
    if share_a > least:
        place, price, share = 0, price_a, share_a
    if share_b > least and (place < 0 or price_b * share < price * share_b):
        place, price, share = 1, price_b, share_b
    if share_c > least and (place < 0 or price_c * share < price * share_c):
        place = 2
    return place
