"""How a joint's link has turned, from the poses that a tracker sees of every link."""

import numpy as np
from scipy.spatial.transform import Rotation

from ctlblocks.recording import Recording

LEAST_TURN = 0.1
"""rad by which a joint must turn on the way to the clamp for its axis to be known."""
MOST_OFF = 0.02
"""Part by which the link may seem to turn more or less than the motor on that way."""
LEAST_SEEN = 0.5
"""Part of the samples in which a frame must be seen."""
_POSE = 7
_UNIT = 0.1
"""Off 1 by which a quaternion's length is none: a frame that was not seen has zeros."""


def tracked_axis(way: Recording, joint: int) -> np.ndarray | None:
    """Find the axis about which a tracked link turns against the one before it, from the way to the clamp.

    Wherever the tracked frames sit on their links, all that turns one against the other is the joint between them.

    Parameters
    ----------
    way : Recording
        With `angle_1` ... (rad, the motors) and `frames_1` ... (seven numbers a frame).
    joint : int
        From 0.

    Returns
    -------
    array, shape (3,), 1, or None
        A unit vector in the frame of the link before; None where the joint turned too little, the links were not seen,
        or what was seen is not the motor's turn.

    Departs
    -------
    The thesis (4.3) takes the actuation plane of a point from an SVD of its positions (`actuation_plane`); a pose shows
    the turn itself, whatever the joint's bearing tilts.
    """
    turn, seen = _turn(way, joint)
    if seen.mean() < LEAST_SEEN:
        return None
    angle = way.select([f"angle_{joint + 1}"]).data[seen, 0].astype(float)
    vector = (turn * turn[0].inv()).as_rotvec()
    moved, seen_moved = angle - angle.mean(), vector - vector.mean(axis=0)
    if not np.ptp(angle) >= LEAST_TURN:
        return None
    axis = moved @ seen_moved / (moved @ moved)
    length = float(np.linalg.norm(axis))
    return axis / length if abs(length - 1) < MOST_OFF else None


def link_motion(recorded: Recording, axis: np.ndarray, joint: int) -> np.ndarray | None:
    """Return how a joint's link has turned from its mean, shape (samples,), rad; None where it was seen too seldom.

    Samples in which it was not seen lie on straight lines between their neighbours.

    Parameters
    ----------
    recorded : Recording
        With `frames_1` ...
    axis : array, shape (3,), 1
        Of `tracked_axis`.
    joint : int
        From 0.
    """
    turn, seen = _turn(recorded, joint)
    if seen.mean() < LEAST_SEEN:
        return None
    found = (turn * turn.mean().inv()).as_rotvec() @ axis
    time = np.arange(len(seen))
    return np.asarray(np.interp(time, time[seen], found))


def tool_pose(recorded: Recording) -> np.ndarray | None:
    """Return the tracked tool's pose against the base's mean one, shape (samples, 7), m and 1; None where unseen."""
    base, base_seen = _frame(recorded, 0)
    tool, seen = _frame(recorded, _POSE)
    if min(base_seen.mean(), seen.mean()) < LEAST_SEEN:
        return None
    turned = Rotation.from_quat(base[base_seen][:, [4, 5, 6, 3]]).mean().inv()
    place = turned.apply(tool[seen, :3] - base[base_seen, :3].mean(axis=0))
    turn = (turned * Rotation.from_quat(tool[seen][:, [4, 5, 6, 3]])).as_quat()
    turn *= np.sign(turn @ turn[0])[:, None]
    time = np.arange(len(seen))
    whole = np.column_stack([place, turn[:, [3, 0, 1, 2]]])
    return np.column_stack([np.interp(time, time[seen], column) for column in whole.T])


def _turn(recorded: Recording, joint: int) -> tuple[Rotation, np.ndarray]:
    """Return the turn of a link against the one before it, where both were seen, and where that is."""
    before, before_seen = _frame(recorded, joint)
    link, link_seen = _frame(recorded, joint + 1)
    seen = before_seen & link_seen
    quaternions = (each[seen][:, [4, 5, 6, 3]] for each in (before, link))
    first, second = (Rotation.from_quat(each) if seen.any() else Rotation.identity(0) for each in quaternions)
    return first.inv() * second, seen


def _frame(recorded: Recording, frame: int) -> tuple[np.ndarray, np.ndarray]:
    """Return one frame's pose, shape (samples, 7), m and 1, and where it was seen."""
    names = [f"frames_{_POSE * frame + place}" for place in range(1, _POSE + 1)]
    pose = recorded.select(names).data.astype(float)
    return pose, np.abs(np.linalg.norm(pose[:, 3:], axis=1) - 1) < _UNIT
