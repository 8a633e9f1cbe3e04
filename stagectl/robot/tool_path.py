"""A path of the tool at constant orientation: joint angles by Newton's method, a feed that begins and ends softly."""

import numpy as np

from stagectl.robot.arm import Arm
from stagectl.robot.kinematics import forward, jacobian

ROUNDS = 6
"""Of Newton's method; over a few centimetres three leave nothing to see."""
CLOSE = 1e-7
"""m, from where it is wanted."""


def joints_at(arm: Arm, home: np.ndarray, position: np.ndarray) -> np.ndarray:
    """Return the joint angles that bring the flange to positions, turned as it is at home: shape (n, 6), rad.

    Parameters
    ----------
    arm : Arm
    home : array, shape (6,), rad
        Not far off.
    position : array, shape (n, 3), m, in the base

    Raises
    ------
    ValueError : the arm does not reach it within its limits.
    """
    wanted = forward(arm, home)[:3, :3]
    angle = np.tile(home, (len(position), 1))
    for _ in range(ROUNDS):
        now = forward(arm, angle)
        gap = np.concatenate([position - now[:, :3, 3], _turn(now[:, :3, :3], wanted)], axis=1)
        angle += np.linalg.solve(jacobian(arm, angle), gap[..., None])[..., 0]
    missed = np.linalg.norm(position - forward(arm, angle)[:, :3, 3], axis=1)
    if not missed.max() <= CLOSE:
        at = position[int(np.argmax(missed))]
        raise ValueError(f"{arm.name} does not reach {at.round(4).tolist()} m, turned as at home")
    arm.refuse_outside(angle)
    return angle


def ramped(time: np.ndarray, seconds: float, ramp: float) -> np.ndarray:
    """Return how long at full feed it would have taken to come as far, s, at times from a beginning: same shape.

    Parameters
    ----------
    time : array, shape (n,), s
        Before 0 and after the end all stands still.
    seconds : float, s
        That the whole way takes at full feed; with the ramps it takes `ramp` longer.
    ramp : float, s, <= seconds
        In which the feed rises, and falls, as a raised cosine.
    """
    since = np.clip(np.asarray(time, float), 0.0, seconds + ramp)
    left = seconds + ramp - since
    way = since - 0.5 * ramp
    begun, ending = since < ramp, left < ramp
    way[begun] = _eased(since[begun], ramp)
    way[ending] = seconds - _eased(left[ending], ramp)
    return np.asarray(way)


def _eased(time: np.ndarray, ramp: float) -> np.ndarray:
    return np.asarray(0.5 * (time - ramp / np.pi * np.sin(np.pi * time / ramp)))


def _turn(now: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Return the small rotation from orientations (n, 3, 3) to another (3, 3): shape (n, 3), rad."""
    return np.asarray(0.5 * np.cross(now, wanted[None], axisa=1, axisb=1, axisc=1).sum(axis=2))
