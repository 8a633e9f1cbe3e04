"""What of a torque neither a force nor friction within its range explains: a bounded least-squares problem of size 6.

Minimize |L^-1 (t - B f - H x)|^2 over forces f and friction -1 <= x <= 1, with noise of covariance L L'.  Householder
reflections that turn L^-1 B upper triangular leave three rows without f: |d - A x|^2, least over the box.
"""

import numpy as np

from rigkit.compiled import njit

JOINTS, PARTS, REST = 6, 3, 3
"""Torques; parts of a force; rows that are left."""
MOST_ROUNDS = 100
NOTHING = 1e-12
"""Relative: a gradient or residual below it is rounding."""
HELD = 1e-6
"""Cosine between residual and what a joint's friction does to it, above which that is no rounding."""

# Rows of `work` (24, 6): 0 to 5 the factor L; 6 to 11 what friction does to the torque, whitened and reflected, and 12
# the torque; 13 to 15 reflectors; 16 friction x; 17 where free x are to go; 18 to 23 for `_least_squares`.
FACTOR, COLUMNS, TORQUE, REFLECTOR, FRICTION, WANTED, BASIS, TRIANGLE = 0, 6, 12, 13, 16, 17, 18, 21
ROWS = 24


@njit(cache=True, nogil=True)
def explain(
    torque: np.ndarray, half: np.ndarray, lever: np.ndarray, covariance: np.ndarray, work: np.ndarray, left: np.ndarray
) -> float:
    """Fill `left` (6,), N m, with what is not explained, and return it squared over the covariance; < 0: no covariance.

    `torque` (6,) N m from the middle of the friction's range, `half` (6,) N m its half width, `lever` (6, 3) m the
    torque of a force.
    """
    if not _factor(covariance, work):
        return -1.0
    for i in range(JOINTS):
        for j in range(JOINTS):
            work[COLUMNS + i, j] = half[j] if i == j else 0.0
        work[TORQUE, i] = torque[i]
    for k in range(PARTS):
        for i in range(JOINTS):
            work[REFLECTOR + k, i] = lever[i, k]
    _whiten(work)
    for k in range(PARTS):
        _reflect(k, work)
    length = _bounded(work)
    if length == 0.0:
        left[:] = 0.0
        return 0.0
    for i in range(JOINTS):
        left[i] = 0.0
    for r in range(REST):
        left[PARTS + r] = _rest(r, work)
    for k in range(PARTS - 1, -1, -1):
        along = 0.0
        for i in range(k, JOINTS):
            along += work[REFLECTOR + k, i] * left[i]
        for i in range(k, JOINTS):
            left[i] -= 2.0 * along * work[REFLECTOR + k, i]
    for i in range(JOINTS - 1, -1, -1):
        total = 0.0
        for j in range(i + 1):
            total += work[FACTOR + i, j] * left[j]
        left[i] = total
    return length


@njit(cache=True, nogil=True)
def is_held(j: int, work: np.ndarray) -> bool:
    """Whether, after `explain`, joint j has the same friction, at a bound, with every force that is as likely."""
    if abs(work[FRICTION, j]) != 1.0:
        return False
    gradient = size = length = 0.0
    for r in range(REST):
        rest = _rest(r, work)
        gradient += work[COLUMNS + PARTS + r, j] * rest
        size += work[COLUMNS + PARTS + r, j] ** 2
        length += rest * rest
    return bool(gradient * gradient > HELD**2 * size * length)


@njit(cache=True, nogil=True)
def _factor(covariance: np.ndarray, work: np.ndarray) -> bool:
    """Factor the covariance after Cholesky; return whether it is positive definite."""
    for i in range(JOINTS):
        for j in range(i + 1):
            total = covariance[i, j]
            for k in range(j):
                total -= work[FACTOR + i, k] * work[FACTOR + j, k]
            if i != j:
                work[FACTOR + i, j] = total / work[FACTOR + j, j]
            elif total > 0.0:
                work[FACTOR + i, i] = np.sqrt(total)
            else:
                return False
    return True


@njit(cache=True, nogil=True)
def _whiten(work: np.ndarray) -> None:
    """Solve with the factor: columns, torque and, in the reflectors' rows, the torque of a force."""
    for i in range(JOINTS):
        for k in range(i):
            share = work[FACTOR + i, k]
            for j in range(JOINTS):
                work[COLUMNS + i, j] -= share * work[COLUMNS + k, j]
            work[TORQUE, i] -= share * work[TORQUE, k]
            for c in range(PARTS):
                work[REFLECTOR + c, i] -= share * work[REFLECTOR + c, k]
        scale = 1.0 / work[FACTOR + i, i]
        for j in range(JOINTS):
            work[COLUMNS + i, j] *= scale
        work[TORQUE, i] *= scale
        for c in range(PARTS):
            work[REFLECTOR + c, i] *= scale


@njit(cache=True, nogil=True)
def _reflect(k: int, work: np.ndarray) -> None:
    """Make the k-th reflector of its column, a unit vector, and reflect all that is left by it."""
    own = work[REFLECTOR + k]
    square = 0.0
    for i in range(k, JOINTS):
        square += own[i] * own[i]
    size = np.sqrt(square)
    square += size * (size + 2.0 * abs(own[k]))
    own[k] += size if own[k] >= 0.0 else -size
    for i in range(k):
        own[i] = 0.0
    scale = 1.0 / np.sqrt(square) if square > 0.0 else 0.0
    for i in range(k, JOINTS):
        own[i] *= scale
    for j in range(JOINTS):
        along = 0.0
        for i in range(k, JOINTS):
            along += own[i] * work[COLUMNS + i, j]
        for i in range(k, JOINTS):
            work[COLUMNS + i, j] -= 2.0 * along * own[i]
    for row in (TORQUE, REFLECTOR + 1, REFLECTOR + 2):
        if row == TORQUE or row > REFLECTOR + k:
            along = 0.0
            for i in range(k, JOINTS):
                along += own[i] * work[row, i]
            for i in range(k, JOINTS):
                work[row, i] -= 2.0 * along * own[i]


@njit(cache=True, nogil=True)
def _rest(r: int, work: np.ndarray) -> float:
    """Return row r of d - A x."""
    total = work[TORQUE, PARTS + r]
    for j in range(JOINTS):
        total -= work[COLUMNS + PARTS + r, j] * work[FRICTION, j]
    return float(total)


@njit(cache=True, nogil=True)
def _bounded(work: np.ndarray) -> float:
    """Fill the friction x of the box that makes |d - A x|^2 least, and return that; exactly 0 where it is rounding.

    Active sets after Stark and Parker, Computational Statistics 10 (1995) 129: at most three x are free at a time.
    """
    columns, target, x, free = work[COLUMNS + PARTS :], work[TORQUE], work[FRICTION], np.zeros(REST, np.int64)
    count, size = 0, 0.0
    for j in range(JOINTS):
        along = 0.0
        for r in range(REST):
            along += columns[r, j] * target[PARTS + r]
            size += abs(columns[r, j])
        x[j] = 1.0 if along >= 0.0 else -1.0
    for r in range(REST):
        size += abs(target[PARTS + r])
    refused = -1
    for _ in range(MOST_ROUNDS):
        best = _most_wrong(free[:count], refused, NOTHING * size, work)
        if best < 0 or count == REST:
            break
        free[count], bound = best, x[best]
        count += 1
        count, moved = _settle(free, count, work)
        refused = -1 if moved or x[best] != bound else best
    length = 0.0
    for r in range(REST):
        length += _rest(r, work) ** 2
    return 0.0 if length <= (10.0 * NOTHING * size) ** 2 else length


@njit(cache=True, nogil=True)
def _most_wrong(free: np.ndarray, refused: int, least: float, work: np.ndarray) -> int:
    """Return which x at a bound would lessen the residual most by leaving it; -1 for none."""
    best, most = -1, least
    for j in range(JOINTS):
        held = j != refused
        for i in free:
            held = held and i != j
        if not held:
            continue
        gradient, size = 0.0, 0.0
        for r in range(REST):
            gradient += work[COLUMNS + PARTS + r, j] * _rest(r, work)
            size += work[COLUMNS + PARTS + r, j] ** 2
        if size > 0.0:
            gain = -gradient * work[FRICTION, j] / np.sqrt(size)
            if gain > most:
                best, most = j, gain
    return best


@njit(cache=True, nogil=True)
def _settle(free: np.ndarray, count: int, work: np.ndarray) -> tuple[int, bool]:
    """Move the free x to where the residual is least, one after the other to a bound where it is in the way.

    Return how many stay free, and whether anything moved.
    """
    x, wanted, moved = work[FRICTION], work[WANTED], False
    while count > 0:
        _least_squares(free, count, work)
        step, stop = 1.0, -1
        for i in range(count):
            j = free[i]
            if abs(wanted[i]) > 1.0:
                reach = (np.sign(wanted[i]) - x[j]) / (wanted[i] - x[j]) if wanted[i] != x[j] else 0.0
                if reach < step:
                    step, stop = reach, i
        for i in range(count):
            j = free[i]
            moved = moved or (step > 0.0 and wanted[i] != x[j])
            x[j] += step * (wanted[i] - x[j])
        if stop < 0:
            return count, moved
        x[free[stop]] = np.sign(wanted[stop])
        for i in range(stop, count - 1):
            free[i] = free[i + 1]
        count -= 1
    return count, moved


@njit(cache=True, nogil=True)
def _least_squares(free: np.ndarray, count: int, work: np.ndarray) -> None:
    """Fill the first `count` of row `WANTED` with the free x of least residual, the others held; Gram-Schmidt."""
    x, basis, triangle, wanted = work[FRICTION], work[BASIS : BASIS + REST], work[TRIANGLE:], work[WANTED]
    for r in range(REST):
        basis[r, REST] = _rest(r, work)
        for i in range(count):
            basis[r, REST] += work[COLUMNS + PARTS + r, free[i]] * x[free[i]]
            basis[r, i] = work[COLUMNS + PARTS + r, free[i]]
    for i in range(count):
        for _ in range(2):  # once more, against rounding
            for k in range(i):
                along = 0.0
                for r in range(REST):
                    along += basis[r, k] * basis[r, i]
                for r in range(REST):
                    basis[r, i] -= along * basis[r, k]
                triangle[k, i] = along if _ == 0 else triangle[k, i] + along
        size = 0.0
        for r in range(REST):
            size += basis[r, i] ** 2
        size = np.sqrt(size)
        triangle[i, i] = size
        scale = 1.0 / size if size > 0.0 else 0.0
        triangle[i, REST] = 0.0
        for r in range(REST):
            basis[r, i] *= scale
            triangle[i, REST] += basis[r, i] * basis[r, REST]
        for r in range(REST):
            basis[r, REST] -= triangle[i, REST] * basis[r, i]
    for i in range(count - 1, -1, -1):
        total = triangle[i, REST]
        for k in range(i + 1, count):
            total -= triangle[i, k] * wanted[k]
        wanted[i] = total / triangle[i, i] if triangle[i, i] > 0.0 else 0.0
