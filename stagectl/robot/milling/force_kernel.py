"""The force that motor torques show, sample by sample: (5.6) solved exactly, and between which bounds the force is.

Where friction within its ranges explains the whole torque, which is the usual case, no noise need be assumed and its
covariance does not matter.  Bounds are those of all forces that are as likely; with slack, of all that friction, with
its ranges that much wider, leaves.
"""

import numpy as np

from rigkit.compiled import njit
from stagectl.robot.milling import force_box_kernel as boxes
from stagectl.robot.milling import force_set_kernel as likely
from stagectl.robot.milling import force_slab_kernel as slabs
from stagectl.robot.milling import residual_kernel as residual

JOINTS, PARTS = 6, 3
CENTRE, SMALLEST = 0, 1
"""Which of the forces: friction nearest to the middle of its ranges over their widths, or the smallest force."""
ONE_POINT = 1e-7
"""Of a friction range: a set of forces that is less wide is one force."""

# Rows of `work` (54, 6): slabs T in columns 0 to 2 of six rows, middle u, left, goal, weight and inverse (three rows
# each), middle before noise is taken off, reach; then those of the two other kernels.
SLAB, MIDDLE, LEFT, GOAL, WEIGHT, INVERSE, GIVEN, REACH, SET = 0, 6, 7, 8, 9, 12, 15, 16, 17
EXPLAIN = SET + likely.ROWS
ROWS = EXPLAIN + residual.ROWS


@njit(cache=True, nogil=True)
def estimate(
    torque: np.ndarray,
    jacobian: np.ndarray,
    friction: np.ndarray,
    slack: np.ndarray,
    covariance: np.ndarray,
    which: int,
    force: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    work: np.ndarray,
) -> tuple[float, bool]:
    """Fill the force (3,) on the tool and its bounds `low` to `high` (3,), N.

    `torque` (6,) of the motors without gravity's, N m; `jacobian` (3 or more, 6) of the tool, m; `friction` (2, 6) its
    lowest and highest torque, N m; `slack` (6,), N m, >= 0, by which bounds take it for wider; `covariance` (6, 6) of
    the noise, (N m)^2.  Return the objective of (5.6), and whether there is one force only that is as likely.
    Objective NaN, force NaN and a box without end: the force is not determined.
    """
    slab, middle, goal = work[SLAB:MIDDLE], work[MIDDLE], work[GOAL][:PARTS]
    weight, inverse = work[WEIGHT:INVERSE, :PARTS], work[INVERSE:GIVEN, :PARTS]
    fit, is_wider = slabs.lay_out(torque, jacobian, friction, slack, slab, middle, work[GIVEN], work[REACH])
    if not fit or not slabs.weigh(slab, weight, inverse):
        force[:], low[:], high[:] = np.nan, -np.inf, np.inf
        return np.nan, False
    slabs.middle_force(middle, slab, inverse, goal)
    objective, is_one = 0.0, False
    force[:] = goal
    if not likely.is_inside(goal, middle, slab):
        objective = _yield_to_noise(friction, covariance, force, work)
        if objective < 0.0:
            force[:], low[:], high[:] = np.nan, -np.inf, np.inf
            return np.nan, False
        is_one = objective > 0.0 and _is_held(slab, work)
        slabs.middle_force(middle, slab, inverse, goal)
    if is_one:
        low[:], high[:] = force, force
    elif is_wider and which == CENTRE and likely.is_inside(goal, middle, slab, ONE_POINT):
        force[:] = goal
    else:
        is_one = _choose(which, force, low, high, work)
    if is_wider:
        _bound(force, low, high, work)
    return objective, is_one


@njit(cache=True, nogil=True)
def _is_held(slab: np.ndarray, work: np.ndarray) -> bool:
    """Whether joints whose friction is the same with all forces that are as likely leave one force only."""
    held, gram, inverse = work[SET : SET + 6], work[SET + 6 : SET + 9], work[SET + 9 : SET + 12]
    for i in range(JOINTS):
        is_held = residual.is_held(i, work[EXPLAIN:])
        for k in range(PARTS):
            held[i, k] = slab[i, k] if is_held else 0.0
    return slabs.weigh(held, gram, inverse)


@njit(cache=True, nogil=True)
def _choose(which: int, force: np.ndarray, low: np.ndarray, high: np.ndarray, work: np.ndarray) -> bool:
    """Fill `force`, which comes as one that is as likely, with the one that is named, and the box of them all.

    Return whether there is one only.
    """
    slab, middle, goal, room = work[SLAB:MIDDLE], work[MIDDLE], work[GOAL][:PARTS], work[SET:EXPLAIN]
    weight, inverse = work[WEIGHT:INVERSE, :PARTS], work[INVERSE:GIVEN, :PARTS]
    if which == SMALLEST:
        for r in range(PARTS):
            goal[r] = 0.0
            for c in range(PARTS):
                weight[r, c] = inverse[r, c] = 1.0 if r == c else 0.0
    seek, reach = not likely.is_inside(goal, middle, slab), work[LEFT]
    reach[:] = 1.0
    if not seek:
        force[:] = goal
    if seek or boxes.search_box(middle, slab, reach, low, high, room) != boxes.FOUND:
        low[:], high[:] = force, force
        likely.search_edges(middle, slab, reach, goal, weight, force, low, high, seek, room)
    if seek:
        likely.search_faces(middle, slab, goal, inverse, weight, force, room)
    likely.widen(force, low, high)
    return _is_one(slab, low, high)


@njit(cache=True, nogil=True)
def _bound(force: np.ndarray, low: np.ndarray, high: np.ndarray, work: np.ndarray) -> None:
    """Fill the box of all forces in the wider slabs; where they have none in common, about what noise leaves of them.

    It holds the `force` that is told as well.
    """
    if not _box(work[GIVEN], low, high, work):
        _box(work[MIDDLE], low, high, work)
    likely.widen(force, low, high)


@njit(cache=True, nogil=True)
def _box(middle: np.ndarray, low: np.ndarray, high: np.ndarray, work: np.ndarray) -> bool:
    """Fill the box of all forces in the wider slabs about `middle` (6,); return whether there are any."""
    slab, reach, room = work[SLAB:MIDDLE], work[REACH], work[SET:EXPLAIN]
    found = boxes.search_box(middle, slab, reach, low, high, room)
    if found != boxes.FOUND:
        low[:], high[:] = np.inf, -np.inf
    if found == boxes.LOST:
        weight, goal = work[WEIGHT:INVERSE, :PARTS], work[GOAL][:PARTS]
        likely.search_edges(middle, slab, reach, goal, weight, goal, low, high, False, room)
    return bool(low[0] <= high[0])


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
    slabs.middle_force(middle, slab, work[INVERSE:GIVEN, :PARTS], force)
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
    slack: np.ndarray,
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
        objective[n], unique[n] = estimate(
            torque[n], jacobian[n], friction[n], slack[n], covariance, which, force[n], low[n], high[n], work
        )
