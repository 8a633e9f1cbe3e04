"""The inertia of each joint from a sweep: what its torque has in step with its acceleration, whatever friction does."""

import numpy as np

SLIDES = 0.005
"""rad/s: faster, friction has the sign of the speed for certain."""
AROUND, ACROSS = 0.012, 0.05
"""s: a speed is the mean over so long before and after, an acceleration the difference of two over so long."""


def joint_inertia(angle: np.ndarray, torque: np.ndarray, knots: np.ndarray, rate: float) -> np.ndarray:
    """Find torque over acceleration of each joint, its motor's and what it carries, over all poses of a sweep.

    By regression beside any friction that depends on speed alone.  Speeds have no lag: friction that falls with a speed
    seen too late would be taken for inertia of a motion that gains it.

    Parameters
    ----------
    angle : array, shape (samples, 6), rad
    torque : array, shape (samples, 6), N m
        Without gravity's.
    knots : array, shape (knots, 6), rad/s, rising
        Between which friction is straight over the speed.
    rate : float, samples/s

    Returns
    -------
    array, shape (6,), kg m^2; NaN where a joint never slides
    """
    near, far = max(1, round(AROUND * rate)), max(1, round(ACROSS * rate))
    inside = slice(far, len(angle) - far)
    speed = (
        (angle[far + near : len(angle) - far + near] - angle[far - near : len(angle) - far - near]) * rate / (2 * near)
    )
    gained = (angle[2 * far :] - 2 * angle[inside] + angle[: -2 * far]) * (rate / far) ** 2
    found = np.full(6, np.nan)
    for joint in range(6):
        slides = np.abs(speed[:, joint]) > SLIDES
        if slides.any():
            both = np.column_stack([gained[slides, joint], torque[inside][slides, joint]])
            both = beside_friction(both, speed[slides, joint], knots[:, joint])
            found[joint] = (both[:, 0] @ both[:, 1]) / max(both[:, 0] @ both[:, 0], 1e-300)
    return found


def beside_friction(signals: np.ndarray, speed: np.ndarray, knots: np.ndarray) -> np.ndarray:
    """Return what is left of signals, shape (samples, columns), by any friction that depends on speed alone.

    Parameters
    ----------
    signals : array, shape (samples, columns), in any units
    speed : array, shape (samples,), rad/s
    knots : array, shape (knots,), rad/s, rising
        Between which friction is straight over the speed.
    """
    friction = hats(speed, knots)
    basis, _ = np.linalg.qr(friction[:, friction.any(axis=0)])
    return np.asarray(signals - basis @ (basis.T @ signals))


def hats(speed: np.ndarray, knots: np.ndarray) -> np.ndarray:
    """Return the weights of knots in linear interpolation, shape (samples, knots).

    Parameters
    ----------
    speed : array, shape (samples,), rad/s
    knots : array, shape (knots,), rad/s, rising
    """
    above = np.clip(np.searchsorted(knots, speed), 1, len(knots) - 1)
    share = np.clip((speed - knots[above - 1]) / (knots[above] - knots[above - 1]), 0.0, 1.0)
    found = np.zeros((len(speed), len(knots)))
    row = np.arange(len(speed))
    found[row, above - 1], found[row, above] = 1 - share, share
    return found
