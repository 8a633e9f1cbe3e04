"""The simulated robot's own geometry: frames, Jacobians, masses and what acts on them."""

import numpy as np

from rigkit.compiled import njit

# `links` (7, 9): angle offset, d, a, alpha; centre of mass x y z in the link's frame; mass; radius of gyration;
# the last row is the payload at the tool point.  `frames` (8, 3, 4): base, links 1 to 6, tool; rotation and origin in
# the base.

GRAVITY = 9.81


@njit(cache=True, nogil=True)
def place(angle: np.ndarray, tilt: np.ndarray, links: np.ndarray, tool: float, frames: np.ndarray) -> None:
    """Fill `frames` from joint angles (rad) and the small rotations `tilt` (6, 2) across each axis (rad)."""
    frames[0] = 0.0
    frames[0, 0, 0] = frames[0, 1, 1] = frames[0, 2, 2] = 1.0
    for i in range(6):
        before, after = frames[i], frames[i + 1]
        cosine, sine = np.cos(angle[i] + links[i, 0]), np.sin(angle[i] + links[i, 0])
        cosine_a, sine_a = np.cos(links[i, 3]), np.sin(links[i, 3])
        for r in range(3):
            x, y, z = _tilted(before[r, 0], before[r, 1], before[r, 2], tilt[i, 0], tilt[i, 1])
            along = cosine * x + sine * y
            beside = cosine * y - sine * x
            after[r, 0] = along
            after[r, 1] = cosine_a * beside + sine_a * z
            after[r, 2] = cosine_a * z - sine_a * beside
            after[r, 3] = before[r, 3] + links[i, 2] * along + links[i, 1] * z
    for r in range(3):
        for c in range(3):
            frames[7, r, c] = frames[6, r, c]
        frames[7, r, 3] = frames[6, r, 3] + tool * frames[6, r, 2]


@njit(cache=True, nogil=True)
def _tilted(x: float, y: float, z: float, about_x: float, about_y: float) -> tuple[float, float, float]:
    """Return a row of a rotation times the rotation by a vector (about_x, about_y, 0), Rodrigues' formula."""
    angle = np.sqrt(about_x * about_x + about_y * about_y)
    if angle == 0.0:
        return x, y, z
    first = np.sin(angle) / angle
    second = (1.0 - np.cos(angle)) / (angle * angle)
    u, v = about_x, about_y
    return (
        x * (1.0 - second * v * v) + y * second * u * v - z * first * v,
        x * second * u * v + y * (1.0 - second * u * u) + z * first * u,
        x * first * v - y * first * u + z * (1.0 - second * (u * u + v * v)),
    )


@njit(cache=True, nogil=True)
def lever(frames: np.ndarray, joint: int, column: int, px: float, py: float, pz: float) -> tuple[float, float, float]:
    """Return the velocity of a point of the base frame (m) as one axis of a joint's frame turns by 1 rad/s."""
    frame = frames[joint]
    ax, ay, az = frame[0, column], frame[1, column], frame[2, column]
    rx, ry, rz = px - frame[0, 3], py - frame[1, 3], pz - frame[2, 3]
    return ay * rz - az * ry, az * rx - ax * rz, ax * ry - ay * rx


@njit(cache=True, nogil=True)
def jacobians(frames: np.ndarray, jacobian: np.ndarray, across: np.ndarray) -> None:
    """Fill the tool's geometric Jacobian about the axes (6, 6) and about the two across each (6, 12)."""
    px, py, pz = frames[7, 0, 3], frames[7, 1, 3], frames[7, 2, 3]
    for i in range(6):
        for column in range(3):
            vx, vy, vz = lever(frames, i, column, px, py, pz)
            target, at = (jacobian, i) if column == 2 else (across, 2 * i + column)
            target[0, at], target[1, at], target[2, at] = vx, vy, vz
            for r in range(3):
                target[3 + r, at] = frames[i, r, column]


@njit(cache=True, nogil=True)
def centres(frames: np.ndarray, links: np.ndarray, centre: np.ndarray) -> None:
    """Fill the centres of mass (7, 3), m in the base frame; the last is the tool point, where the payload is."""
    for k in range(7):
        for r in range(3):
            f = frames[k + 1]
            centre[k, r] = f[r, 3] + f[r, 0] * links[k, 4] + f[r, 1] * links[k, 5] + f[r, 2] * links[k, 6]


@njit(cache=True, nogil=True)
def masses(frames: np.ndarray, centre: np.ndarray, links: np.ndarray, mass: np.ndarray) -> None:
    """Fill the mass matrix (6, 6), kg m^2, of bodies whose inertia is the same about every axis."""
    mass[:] = 0.0
    reach = np.empty((6, 3))
    for k in range(7):
        load = links[k, 7]
        inertia = load * links[k, 8] ** 2
        for i in range(min(k, 5) + 1):
            reach[i, 0], reach[i, 1], reach[i, 2] = lever(frames, i, 2, centre[k, 0], centre[k, 1], centre[k, 2])
            for j in range(i + 1):
                a, b = frames[i], frames[j]
                turned = a[0, 2] * b[0, 2] + a[1, 2] * b[1, 2] + a[2, 2] * b[2, 2]
                moved = reach[i, 0] * reach[j, 0] + reach[i, 1] * reach[j, 1] + reach[i, 2] * reach[j, 2]
                mass[i, j] += load * moved + inertia * turned
    for i in range(6):
        for j in range(i):
            mass[j, i] = mass[i, j]


@njit(cache=True, nogil=True)
def weights(frames: np.ndarray, centre: np.ndarray, links: np.ndarray, moment: np.ndarray) -> None:
    """Fill what gravity does about x, y and z of the frame before each joint (6, 3), N m."""
    moment[:] = 0.0
    for k in range(7):
        for i in range(min(k, 5) + 1):
            for column in range(3):
                up = lever(frames, i, column, centre[k, 0], centre[k, 1], centre[k, 2])[2]
                moment[i, column] -= links[k, 7] * GRAVITY * up


@njit(cache=True, nogil=True)
def whirls(frames: np.ndarray, centre: np.ndarray, links: np.ndarray, speed: np.ndarray, moment: np.ndarray) -> None:
    """Fill the centrifugal and Coriolis load on each joint (6,), N m: what holds the arm at zero joint acceleration.

    Bodies of equal inertia about all axes feel no gyroscopic moment, but the direction of their spin changes.
    """
    moment[:] = 0.0
    spin = np.zeros((5, 3))  # of the link: turning, its change, its origin's acceleration, an arm on it, that end's
    omega, alpha, origin, arm, end = spin[0], spin[1], spin[2], spin[3], spin[4]
    for k in range(7):
        joint = min(k, 5)
        if k < 6:
            x, y, z = frames[k, 0, 2], frames[k, 1, 2], frames[k, 2, 2]
            alpha[0] += speed[k] * (omega[1] * z - omega[2] * y)
            alpha[1] += speed[k] * (omega[2] * x - omega[0] * z)
            alpha[2] += speed[k] * (omega[0] * y - omega[1] * x)
            omega[0], omega[1], omega[2] = omega[0] + speed[k] * x, omega[1] + speed[k] * y, omega[2] + speed[k] * z
        for r in range(3):
            arm[r] = centre[k, r] - frames[joint, r, 3]
        _swing(spin)
        for i in range(joint + 1):
            vx, vy, vz = lever(frames, i, 2, centre[k, 0], centre[k, 1], centre[k, 2])
            twist = alpha[0] * frames[i, 0, 2] + alpha[1] * frames[i, 1, 2] + alpha[2] * frames[i, 2, 2]
            moment[i] += links[k, 7] * (end[0] * vx + end[1] * vy + end[2] * vz + links[k, 8] ** 2 * twist)
        if k < 5:
            for r in range(3):
                arm[r] = frames[k + 1, r, 3] - frames[k, r, 3]
            _swing(spin)
            for r in range(3):
                origin[r] = end[r]


@njit(cache=True, nogil=True)
def _swing(spin: np.ndarray) -> None:
    """Fill the last row with the acceleration of an arm's end, m/s^2: a + alpha x r + omega x (omega x r)."""
    omega, alpha, arm = spin[0], spin[1], spin[3]
    along = omega[0] * arm[0] + omega[1] * arm[1] + omega[2] * arm[2]
    square = omega[0] ** 2 + omega[1] ** 2 + omega[2] ** 2
    for r in range(3):
        i, j = (r + 1) % 3, (r + 2) % 3
        spin[4, r] = spin[2, r] + alpha[i] * arm[j] - alpha[j] * arm[i] + omega[r] * along - arm[r] * square
