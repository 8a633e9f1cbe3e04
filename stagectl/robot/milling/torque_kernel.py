"""From motor angles to what force estimation needs of an arm, sample by sample: speed, Jacobian, gravity, friction."""

import numpy as np

from rigkit.compiled import njit
from rigkit.flush_kernel import flushed

JOINTS = 6

# `chain` (6, 5): offset (rad), d, a (m), cosine and sine of alpha.  `frames` (7, 3, 4): base and links, rotation and
# origin (m).  `moments` (6, 4): of each link its mass times the centre of mass in its own frame (kg m), and mass (kg).


@njit(cache=True, nogil=True)
def place(angle: np.ndarray, chain: np.ndarray, frames: np.ndarray) -> None:
    """Fill `frames` for joint angles (rad), standard Denavit-Hartenberg."""
    for r in range(3):
        for c in range(4):
            frames[0, r, c] = 1.0 if r == c else 0.0
    for i in range(JOINTS):
        cosine, sine = np.cos(angle[i] + chain[i, 0]), np.sin(angle[i] + chain[i, 0])
        before, after = frames[i], frames[i + 1]
        for r in range(3):
            x, y, z = before[r, 0], before[r, 1], before[r, 2]
            along, beside = cosine * x + sine * y, cosine * y - sine * x
            after[r, 0] = along
            after[r, 1] = chain[i, 3] * beside + chain[i, 4] * z
            after[r, 2] = chain[i, 3] * z - chain[i, 4] * beside
            after[r, 3] = before[r, 3] + chain[i, 2] * along + chain[i, 1] * z


@njit(cache=True, nogil=True)
def levers(frames: np.ndarray, jacobian: np.ndarray) -> None:
    """Fill the first three rows of the flange's Jacobian (3 or more, 6), m."""
    flange = frames[JOINTS]
    for i in range(JOINTS):
        axis = frames[i]
        x, y, z = flange[0, 3] - axis[0, 3], flange[1, 3] - axis[1, 3], flange[2, 3] - axis[2, 3]
        jacobian[0, i] = axis[1, 2] * z - axis[2, 2] * y
        jacobian[1, i] = axis[2, 2] * x - axis[0, 2] * z
        jacobian[2, i] = axis[0, 2] * y - axis[1, 2] * x


@njit(cache=True, nogil=True)
def carry(frames: np.ndarray, moments: np.ndarray, gravity: float, torque: np.ndarray) -> None:
    """Fill the torque (6,), N m, that holds the links up; `gravity` (m/s^2) is along -z of the base."""
    mass = along_x = along_y = 0.0  # of what a joint carries, moments about the base's origin
    for i in range(JOINTS - 1, -1, -1):
        link, axis = frames[i + 1], frames[i]
        mass += moments[i, 3]
        along_x += moments[i, 3] * link[0, 3]
        along_y += moments[i, 3] * link[1, 3]
        for c in range(3):
            along_x += link[0, c] * moments[i, c]
            along_y += link[1, c] * moments[i, c]
        x, y = along_x - mass * axis[0, 3], along_y - mass * axis[1, 3]
        torque[i] = gravity * (axis[0, 2] * y - axis[1, 2] * x)


@njit(cache=True, nogil=True)
def friction_range(speed: np.ndarray, knots: np.ndarray, bounds: np.ndarray, found: np.ndarray) -> bool:
    """Fill lowest and highest friction (2, 6), N m, at joint speeds (6,), rad/s, straight between knots.

    `knots` (knots, 6), rad/s, rise; `bounds` (2, knots, 6).  Return whether all speeds are between first and last knot.
    """
    last = len(knots) - 1
    for i in range(JOINTS):
        if not knots[0, i] <= speed[i] <= knots[last, i]:
            return False
        below, above = 0, last
        while above - below > 1:
            half = (below + above) // 2
            if knots[half, i] <= speed[i]:
                below = half
            else:
                above = half
        share = (speed[i] - knots[below, i]) / (knots[above, i] - knots[below, i])
        for side in range(2):
            found[side, i] = (1.0 - share) * bounds[side, below, i] + share * bounds[side, above, i]
    return True


@njit(cache=True, nogil=True)
def friction_ranges(speed: np.ndarray, knots: np.ndarray, bounds: np.ndarray, found: np.ndarray) -> None:
    """Fill `found` (samples, 2, 6), N m, from `speed` (samples, 6), rad/s; NaN where any is beyond the knots."""
    for n in range(len(speed)):
        if not friction_range(speed[n], knots, bounds, found[n]):
            found[n] = np.nan


@njit(cache=True, nogil=True)
def follow_speed(angle: np.ndarray, last: np.ndarray, speed: np.ndarray, pole: float, rate: float) -> None:
    """Go on by a sample: `speed` (6,), rad/s, the smoothed difference of angles; NaN in `last` begins at rest."""
    for i in range(JOINTS):
        if np.isfinite(angle[i]) and np.isfinite(last[i]):
            speed[i] = flushed(pole * speed[i] + (1.0 - pole) * (angle[i] - last[i]) * rate)
        else:
            speed[i] = 0.0
        last[i] = angle[i]


@njit(cache=True, nogil=True)
def follow_speeds(angle: np.ndarray, pole: float, rate: float, speed: np.ndarray) -> None:
    """Fill `speed` (samples, 6), rad/s, from a whole record of angles."""
    last, now = np.full(JOINTS, np.nan), np.zeros(JOINTS)
    for n in range(len(angle)):
        follow_speed(angle[n], last, now, pole, rate)
        speed[n] = now
