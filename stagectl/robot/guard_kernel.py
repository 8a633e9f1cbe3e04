"""What may be sent to the robot: a reference and its correction, held against every limit, then let through or not."""

import numpy as np

from rigkit.compiled import njit

FINE, NOT_FINITE, POSITION, SPEED, CORRECTION, ROTATION, TOOL_SPEED, BOX = range(8)
"""What `check_joints` and `check_pose` find."""


@njit(cache=True, nogil=True)
def flange(angle: np.ndarray, chain: np.ndarray, tool: float, pose: np.ndarray) -> None:
    """Fill `pose` (3, 4), rotation and origin (m), for joint angles (rad); `chain` (joints, 4): offset, d, a, alpha."""
    for r in range(3):
        for c in range(4):
            pose[r, c] = 1.0 if r == c else 0.0
    for i in range(len(angle)):
        cosine, sine = np.cos(angle[i] + chain[i, 0]), np.sin(angle[i] + chain[i, 0])
        twist_c, twist_s = np.cos(chain[i, 3]), np.sin(chain[i, 3])
        for r in range(3):
            x, y, z = pose[r, 0], pose[r, 1], pose[r, 2]
            along, beside = cosine * x + sine * y, cosine * y - sine * x
            pose[r, 3] += chain[i, 2] * along + chain[i, 1] * z
            pose[r, 0] = along
            pose[r, 1] = twist_c * beside + twist_s * z
            pose[r, 2] = twist_c * z - twist_s * beside
    for r in range(3):
        pose[r, 3] += tool * pose[r, 2]


@njit(cache=True, nogil=True)
def check_joints(
    nominal: np.ndarray, wanted: np.ndarray, last: np.ndarray, limits: np.ndarray, chain: np.ndarray, work: np.ndarray
) -> tuple[int, int, float, float]:
    """Return what is wrong with joint angles `wanted` (rad) beside `nominal` and after `last`: which, where, how much.

    `limits` (5, 6): lowest, highest (rad), most in a cycle (rad); correction (m), rotation (rad), tool's way in a cycle
    (m), tool length (m); box, lowest and highest x y z (m).  `work` (3, 3, 4) is room for poses.
    """
    for i in range(len(wanted)):
        if not (np.isfinite(nominal[i]) and np.isfinite(wanted[i])):
            return NOT_FINITE, i, wanted[i], 0.0
        if not limits[0, i] <= wanted[i] <= limits[1, i]:
            return POSITION, i, wanted[i], limits[0, i] if wanted[i] < limits[0, i] else limits[1, i]
        if not abs(wanted[i] - last[i]) <= limits[2, i]:
            return SPEED, i, abs(wanted[i] - last[i]), limits[2, i]
    for at, angle in enumerate((nominal, wanted, last)):
        flange(angle, chain, limits[3, 3], work[at])
    return _check_tool(limits, work)


@njit(cache=True, nogil=True)
def _check_tool(limits: np.ndarray, work: np.ndarray) -> tuple[int, int, float, float]:
    moved = turned = way = 0.0
    for r in range(3):
        moved += (work[1, r, 3] - work[0, r, 3]) ** 2
        way += (work[1, r, 3] - work[2, r, 3]) ** 2
        for c in range(3):
            turned += (work[1, r, c] - work[0, r, c]) ** 2
    moved, way, turned = np.sqrt(moved), np.sqrt(way), np.sqrt(0.5 * turned)  # of a small rotation, its angle
    if not moved <= limits[3, 0]:
        return CORRECTION, 0, moved, limits[3, 0]
    if not turned <= limits[3, 1]:
        return ROTATION, 0, turned, limits[3, 1]
    if not way <= limits[3, 2]:
        return TOOL_SPEED, 0, way, limits[3, 2]
    for r in range(3):
        if not limits[4, r] <= work[1, r, 3] <= limits[4, 3 + r]:
            low = work[1, r, 3] < limits[4, r]
            return BOX, r, work[1, r, 3], limits[4, r] if low else limits[4, 3 + r]
    return FINE, 0, 0.0, 0.0


@njit(cache=True, nogil=True)
def check_pose(
    nominal: np.ndarray, wanted: np.ndarray, last: np.ndarray, limits: np.ndarray, turn: float, work: np.ndarray
) -> tuple[int, int, float, float]:
    """Return what is wrong with a pose (7,), m and quaternion, as `check_joints` does; `turn` is most in a cycle."""
    for i in range(7):
        if not (np.isfinite(nominal[i]) and np.isfinite(wanted[i])):
            return NOT_FINITE, i, wanted[i], 0.0
    for at, pose in enumerate((nominal, wanted, last)):
        _matrix(pose, work[at])
    turned = 0.0
    for r in range(3):
        for c in range(3):
            turned += (work[1, r, c] - work[2, r, c]) ** 2
    if not np.sqrt(0.5 * turned) <= turn:
        return SPEED, 6, np.sqrt(0.5 * turned), turn
    return _check_tool(limits, work)


@njit(cache=True, nogil=True)
def _matrix(pose: np.ndarray, frame: np.ndarray) -> None:
    w, x, y, z = pose[3], pose[4], pose[5], pose[6]
    frame[0, 0], frame[0, 1], frame[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    frame[1, 0], frame[1, 1], frame[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    frame[2, 0], frame[2, 1], frame[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
    for r in range(3):
        frame[r, 3] = pose[r]
