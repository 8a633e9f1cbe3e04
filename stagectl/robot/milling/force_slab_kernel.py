"""What each joint's torque leaves of the forces on the tool: a slab of them, as wide as its friction's range."""

import numpy as np

from rigkit.compiled import njit

JOINTS, PARTS = 6, 3
SINGULAR = 1e-12
"""Square of a sine below which two directions of force, or of force and moment, cannot be told apart."""
NO_LEVER = 1e-9
"""Of the longest lever: a joint whose axis goes so near the tool has none, its torque tells nothing of the force."""


@njit(cache=True, nogil=True)
def lay_out(
    torque: np.ndarray,
    jacobian: np.ndarray,
    friction: np.ndarray,
    slack: np.ndarray,
    slab: np.ndarray,
    middle: np.ndarray,
    given: np.ndarray,
    reach: np.ndarray,
) -> tuple[bool, bool]:
    """Fill slabs T (6, 3), their `middle` and `reach` (6,): friction over half its range is `middle - slab f`.

    `given` (6,) is the middle, 0 for a joint without lever.  Return whether all numbers are fit, and whether any slab
    reaches further than friction's range.
    """
    longest, is_wider = 0.0, False
    for i in range(JOINTS):
        for k in range(PARTS):
            if not np.isfinite(jacobian[k, i]):
                return False, False
            longest = max(longest, abs(jacobian[k, i]))
    for i in range(JOINTS):
        half = 0.5 * (friction[1, i] - friction[0, i])
        if not (half > 0.0 and half < np.inf and np.isfinite(torque[i]) and 0.0 <= slack[i] < np.inf):
            return False, False
        middle[i] = (torque[i] - 0.5 * (friction[0, i] + friction[1, i])) / half
        reach[i] = 1.0 + slack[i] / half
        is_wider = is_wider or slack[i] > 0.0
        lever = max(abs(jacobian[0, i]), abs(jacobian[1, i]), abs(jacobian[2, i]))
        has_lever = lever > NO_LEVER * longest
        for k in range(PARTS):
            slab[i, k] = -jacobian[k, i] / half if has_lever else 0.0
        given[i] = middle[i] if has_lever else 0.0
    return True, is_wider


@njit(cache=True, nogil=True)
def weigh(slab: np.ndarray, weight: np.ndarray, inverse: np.ndarray) -> bool:
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
def middle_force(middle: np.ndarray, slab: np.ndarray, inverse: np.ndarray, goal: np.ndarray) -> None:
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
