"""The force that motor torques show, sample by sample: (5.6) solved exactly, with all forces that are as likely.

Where friction within its ranges explains the whole torque, which is the usual case, no noise need be assumed and its
covariance does not matter.
"""

import numpy as np
from numba import njit

from stagectl.robot.milling import force_set_kernel as likely
from stagectl.robot.milling import residual_kernel as residual

JOINTS, PARTS = 6, 3
CENTRE, SMALLEST = 0, 1
"""Which of the forces: friction nearest to the middle of its ranges over their widths, or the smallest force."""
SINGULAR = 1e-12
"""Square of a sine below which two directions of force, or of force and moment, cannot be told apart."""
NO_LEVER = 1e-9
"""Of the longest lever: a joint whose axis goes so near the tool has none, its torque tells nothing of the force."""
ONE_POINT = 1e-7
"""Of a friction range: a set of forces that is less wide is one force."""

# Rows of `work` (52, 6): slabs T in columns 0 to 2 of six rows, middle u, left, goal, weight and inverse (three rows
# each), force; then those of the two other kernels.
SLAB, MIDDLE, LEFT, GOAL, WEIGHT, INVERSE, SET = 0, 6, 7, 8, 9, 12, 15
EXPLAIN = SET + likely.ROWS
ROWS = EXPLAIN + residual.ROWS


@njit(cache=True, nogil=True)
def estimate(
    torque: np.ndarray,
    jacobian: np.ndarray,
    friction: np.ndarray,
    covariance: np.ndarray,
    which: int,
    force: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    work: np.ndarray,
) -> tuple[float, bool]:
    """Fill the force (3,) on the tool and the box `low` to `high` (3,) of all that are as likely, N.

    `torque` (6,) of the motors without gravity's, N m; `jacobian` (3 or more, 6) of the tool, m; `friction` (2, 6) its
    lowest and highest torque, N m; `covariance` (6, 6) of the noise, (N m)^2.  Return the objective of (5.6), and
    whether there is one force only.  Objective NaN, force NaN and a box without end: the force is not determined.
    """
    slab, middle, goal = work[SLAB:MIDDLE], work[MIDDLE], work[GOAL][:PARTS]
    weight, inverse = work[WEIGHT:INVERSE, :PARTS], work[INVERSE:SET, :PARTS]
    if not _lay_out(torque, jacobian, friction, slab, middle) or not _invert(slab, weight, inverse):
        force[:], low[:], high[:] = np.nan, -np.inf, np.inf
        return np.nan, False
    _goal(middle, slab, inverse, goal)
    objective = 0.0
    force[:] = goal
    if not likely.is_inside(goal, middle, slab):
        objective = _yield_to_noise(friction, covariance, force, work)
        if objective < 0.0:
            force[:], low[:], high[:] = np.nan, -np.inf, np.inf
            return np.nan, False
        _goal(middle, slab, inverse, goal)
    if which == SMALLEST:
        for r in range(PARTS):
            goal[r] = 0.0
            for c in range(PARTS):
                weight[r, c] = inverse[r, c] = 1.0 if r == c else 0.0
    seek = not likely.is_inside(goal, middle, slab)
    if not seek:
        force[:] = goal
    low[:], high[:] = force, force
    room = work[SET:EXPLAIN]
    likely.search_edges(middle, slab, goal, weight, force, low, high, seek, room)
    if seek:
        likely.search_faces(middle, slab, goal, inverse, weight, force, room)
        likely.widen(force, low, high)
    return objective, _is_one(slab, low, high)


@njit(cache=True, nogil=True)
def _lay_out(
    torque: np.ndarray, jacobian: np.ndarray, friction: np.ndarray, slab: np.ndarray, middle: np.ndarray
) -> bool:
    """Fill slabs and middle: friction over half its range is `middle - slab f`; return whether all numbers are fit."""
    longest = 0.0
    for i in range(JOINTS):
        for k in range(PARTS):
            if not np.isfinite(jacobian[k, i]):
                return False
            longest = max(longest, abs(jacobian[k, i]))
    for i in range(JOINTS):
        half = 0.5 * (friction[1, i] - friction[0, i])
        if not (half > 0.0 and half < np.inf and np.isfinite(torque[i])):
            return False
        middle[i] = (torque[i] - 0.5 * (friction[0, i] + friction[1, i])) / half
        lever = max(abs(jacobian[0, i]), abs(jacobian[1, i]), abs(jacobian[2, i]))
        for k in range(PARTS):
            slab[i, k] = -jacobian[k, i] / half if lever > NO_LEVER * longest else 0.0
    return True


@njit(cache=True, nogil=True)
def _invert(slab: np.ndarray, weight: np.ndarray, inverse: np.ndarray) -> bool:
    """Fill T'T and its inverse, (3, 3) each; return whether it is regular."""
    for r in range(PARTS):
        for c in range(PARTS):
            weight[r, c] = 0.0
            for i in range(JOINTS):
                weight[r, c] += slab[i, r] * slab[i, c]
    for r in range(PARTS):
        for c in range(PARTS):
            a, b, d, e = (r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3
            inverse[c, r] = weight[a, d] * weight[b, e] - weight[a, e] * weight[b, d]
    determinant = weight[0, 0] * inverse[0, 0] + weight[0, 1] * inverse[1, 0] + weight[0, 2] * inverse[2, 0]
    if not determinant > SINGULAR * weight[0, 0] * weight[1, 1] * weight[2, 2]:
        return False
    for r in range(PARTS):
        for c in range(PARTS):
            inverse[r, c] /= determinant
    return True


@njit(cache=True, nogil=True)
def _goal(middle: np.ndarray, slab: np.ndarray, inverse: np.ndarray, goal: np.ndarray) -> None:
    """Fill the force (3,) with which friction is nearest to the middle of its ranges, wherever it is."""
    goal[:] = 0.0
    for _ in range(2):  # once more, against the rounding of T'T
        along_x = along_y = along_z = 0.0
        for i in range(JOINTS):
            off = middle[i] - slab[i, 0] * goal[0] - slab[i, 1] * goal[1] - slab[i, 2] * goal[2]
            along_x += slab[i, 0] * off
            along_y += slab[i, 1] * off
            along_z += slab[i, 2] * off
        for r in range(PARTS):
            goal[r] += inverse[r, 0] * along_x + inverse[r, 1] * along_y + inverse[r, 2] * along_z


@njit(cache=True, nogil=True)
def _yield_to_noise(
    friction: np.ndarray,
    covariance: np.ndarray,
    force: np.ndarray,
    work: np.ndarray,
) -> float:
    """Take what only noise explains off the slabs' middles; fill a `force` that is left; return the objective."""
    slab, middle, left, room = work[SLAB:MIDDLE], work[MIDDLE], work[LEFT], work[EXPLAIN:]
    half, off, lever = work[SET], work[SET + 1], work[SET + 2 : SET + 8, :PARTS]
    for i in range(JOINTS):
        half[i] = 0.5 * (friction[1, i] - friction[0, i])
        off[i] = middle[i] * half[i]
        for k in range(PARTS):
            lever[i, k] = slab[i, k] * half[i]
    objective = residual.explain(off, half, lever, covariance, room, left)
    if objective < 0.0:
        return objective
    for i in range(JOINTS):
        middle[i] = (off[i] - left[i]) / half[i] - room[residual.FRICTION, i]
    _goal(middle, slab, work[INVERSE:SET, :PARTS], force)
    for i in range(JOINTS):
        middle[i] += room[residual.FRICTION, i]
    return objective


@njit(cache=True, nogil=True)
def _is_one(slab: np.ndarray, low: np.ndarray, high: np.ndarray) -> bool:
    """Whether the box is so small that it is one force."""
    for i in range(JOINTS):
        for k in range(PARTS):
            if abs(slab[i, k]) * (high[k] - low[k]) > ONE_POINT:
                return False
    return True


@njit(cache=True, nogil=True)
def estimate_all(
    torque: np.ndarray,
    jacobian: np.ndarray,
    friction: np.ndarray,
    covariance: np.ndarray,
    which: int,
    force: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    unique: np.ndarray,
    objective: np.ndarray,
    work: np.ndarray,
) -> None:
    """Do `estimate` for stacks of everything but the covariance; `unique` and `objective`, (samples,)."""
    for n in range(len(torque)):
        found = estimate(torque[n], jacobian[n], friction[n], covariance, which, force[n], low[n], high[n], work)
        objective[n], unique[n] = found
