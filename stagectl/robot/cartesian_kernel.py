"""Joint corrections from Cartesian ones, sample by sample: the Jacobian, damped where it is near singular."""

import numpy as np

from rigkit.compiled import njit
from stagectl.robot.guard_kernel import flange

TOOL_ARM = np.dtype(
    [
        ("chain", "f8", (6, 4)),  # of `guard_kernel.flange`
        ("tool", "f8"),  # m, from the flange to the tool point
        ("length", "f8"),  # m, which weighs rotations against translations
        ("least", "f8"),  # m: smaller singular values of the so weighed Jacobian are damped
        # room
        ("jacobian", "f8", (6, 6)),
        ("normal", "f8", (6, 6)),  # the factor of the normal matrix
        ("inverse", "f8", (6, 6)),  # of that factor
        ("right", "f8", 6),
        ("pose", "f8", (3, 4)),
    ],
    align=True,
)
"""An arm of six joints with its tool."""


@njit(cache=True, nogil=True)
def correct(
    angle: np.ndarray,
    translation: np.ndarray,
    rotation: np.ndarray,
    correction: np.ndarray,
    arms: np.ndarray,
) -> None:
    """Fill `correction` (rad) from angles (rad), translations (m) and rotations (rad) of the tool, base axes.

    All are shape (frames, 6) or (frames, 3); `arms` is of one `TOOL_ARM`.
    """
    arm = arms[0]
    length, least, work, right, inverse = arm.length, arm.least, arm.jacobian, arm.right, arm.inverse
    for n in range(angle.shape[0]):
        _jacobian(angle[n], arm.chain, arm.tool, work, arm.pose)
        for r in range(3, 6):
            for c in range(6):
                work[r, c] *= length
        smallest = _factor(0.0, work, arm.normal, inverse)
        if smallest < least:
            _factor((least * (1.0 - (smallest / least) ** 2)) ** 2, work, arm.normal, inverse)
        for c in range(6):
            right[c] = 0.0
            for r in range(3):
                right[c] += work[r, c] * translation[n, r] + work[3 + r, c] * length * rotation[n, r]
        for i in range(6):
            correction[n, i] = 0.0
            for k in range(6):
                along = 0.0
                for j in range(k + 1):
                    along += inverse[k, j] * right[j]
                correction[n, i] += inverse[k, i] * along


@njit(cache=True, nogil=True)
def _jacobian(angle: np.ndarray, chain: np.ndarray, tool: float, work: np.ndarray, pose: np.ndarray) -> None:
    flange(angle, chain, tool, pose)
    x, y, z = pose[0, 3], pose[1, 3], pose[2, 3]
    for i in range(6):
        flange(angle[:i], chain, 0.0, pose)
        ax, ay, az = pose[0, 2], pose[1, 2], pose[2, 2]
        rx, ry, rz = x - pose[0, 3], y - pose[1, 3], z - pose[2, 3]
        work[0, i], work[1, i], work[2, i] = ay * rz - az * ry, az * rx - ax * rz, ax * ry - ay * rx
        work[3, i], work[4, i], work[5, i] = ax, ay, az


@njit(cache=True, nogil=True)
def _factor(damping: float, work: np.ndarray, normal: np.ndarray, inverse: np.ndarray) -> float:
    """Factor J'J + damping and invert the factor; return a lower bound of the smallest singular value, or 0."""
    for i in range(6):
        for j in range(i + 1):
            total = damping if i == j else 0.0
            for r in range(6):
                total += work[r, i] * work[r, j]
            for k in range(j):
                total -= normal[i, k] * normal[j, k]
            if i != j:
                normal[i, j] = total / normal[j, j]
            elif total > 1e-14:
                normal[i, i] = np.sqrt(total)
            else:
                return 0.0
    squares = 0.0
    for j in range(6):
        for i in range(6):
            if i < j:
                inverse[i, j] = 0.0
                continue
            total = 1.0 if i == j else 0.0
            for k in range(j, i):
                total -= normal[i, k] * inverse[k, j]
            inverse[i, j] = total / normal[i, i]
            squares += inverse[i, j] ** 2
    return float(1.0 / np.sqrt(squares))
