"""Gravity, friction ranges and inertia from a record of a sweep, with their fit on validation motions."""

from dataclasses import dataclass

import numpy as np

from calibration.milling.inertia_fit import SLIDES, beside_friction, joint_inertia
from ctlblocks.recording import Recording
from stagectl.robot.arm import Arm
from stagectl.robot.learning_config import Friction
from stagectl.robot.milling.friction_range import FrictionRange, smoothed_speeds
from stagectl.robot.milling.gravity import Gravity, gravity_regressor, smallest_moments

KNOTS = 25
"""Of a range, both ways together."""
FINEST = 0.002
"""rad/s: below it knots are evenly apart, above it evenly in the logarithm."""
STEADY, STEADIEST = 0.15, 0.03
"""rad/s^2: where any joint gains speed faster, its inertia would count as friction; as gravity."""
LOOK = 0.1
"""s, over which that is looked at, and by whose mean noise is told from friction."""
FEWEST = 20
"""Samples that make the range at a knot."""
SMOOTH = 5
"""Samples of a mean; friction of a range is that of such means."""
HELD_BACK = 3
"""One step in so many is not fitted to."""


class SweepError(ValueError):
    """A record that does not tell gravity and friction; says why."""


@dataclass(frozen=True, eq=False)
class TorqueFit:
    """What else the sweep says, of gravity and friction on held-back motions.

    Parameters
    ----------
    fit : array, shape (6,), 1
        NRMSE fit of torques by gravity and the middle of friction's range, where a joint slides; 1 is perfect.
    inside : array, shape (6,), 1
        Part of the samples, means over 20 ms, whose friction is in its range.
    residual : array, shape (6,), N m
        Rms of what they leave there, noise included.
    combinations : int
        Of the links' moments that the sweep tells.
    inertia : array, shape (6,), kg m^2
        Of each joint, from all motions; 0 where they do not tell it.
    untold : tuple of int
        Joints, from 1, whose inertia they do not tell: these gain speed too slowly.
    """

    fit: np.ndarray
    inside: np.ndarray
    residual: np.ndarray
    combinations: int
    inertia: np.ndarray
    untold: tuple[int, ...] = ()

    @property
    def note(self) -> str:
        """What is to be said of it; nothing where all is told."""
        if not self.untold:
            return ""
        return (
            f"the sweep does not determine the inertia of joints {', '.join(map(str, self.untold))}, whose "
            "acceleration is too small: it is taken as 0, and forces from motor torques contain the inertial torque"
        )


def friction_and_gravity(recorded: Recording, arm: Arm, settings: Friction) -> tuple[FrictionRange, Gravity, TorqueFit]:
    """Find gravity, friction ranges, the noise of the torques and the joints' inertia.

    Parameters
    ----------
    recorded : Recording
        Of a sweep: channels `angle_1` to `angle_6` (rad), `torque_1` to `torque_6` (N m) and `step_1` (1).
    arm : Arm
        With its tool.
    settings : Friction

    Raises
    ------
    SweepError : too little steady motion, or a joint that does not turn both ways.

    Source
    ------
    Sornmo 2015, p. 5.4 "an experiment where the robot was moved throughout the major part of its workspace".
    """
    angle, torque = (
        recorded.select([f"{name}_{joint}" for joint in range(1, 7)]).data.astype(float) for name in ("angle", "torque")
    )
    step = recorded.select(["step_1"]).data[:, 0]
    speed = smoothed_speeds(angle, recorded.rate, settings.smoothing)
    gained = _gained(angle, recorded.rate)
    steady = gained < STEADY
    fitted, held = steady & (step % HELD_BACK != 0), steady & (step % HELD_BACK == 0)
    knots = _knots(speed[steady])
    slides = np.abs(speed) > SLIDES
    gravity, combinations = _gravity(
        arm, angle, torque, speed, knots, (fitted & (gained < STEADIEST))[:, None] & slides
    )
    friction = torque - gravity.torque(arm, angle)
    covariance = _noise(friction, fitted & slides.all(axis=1), round(LOOK * recorded.rate))
    smooth = _means(friction, SMOOTH)
    low, high = _ranges(smooth[fitted], speed[fitted], knots, settings.left_out)
    found = FrictionRange(knots, low, high, covariance, settings.smoothing)
    inertia = joint_inertia(angle, friction, knots, recorded.rate)
    untold = tuple((np.flatnonzero(~(inertia > 0)) + 1).tolist())
    inertia = np.maximum(inertia, 0.0)
    judged = _fit(found, gravity.torque(arm, angle[held]), torque[held], smooth[held], speed[held], slides[held])
    return found, gravity, TorqueFit(*judged, combinations, inertia, untold)


def known_speeds(angle: np.ndarray, rate: float, smoothing: float) -> np.ndarray:
    """Return up to which speed, both ways, a sweep shows the friction of each joint, shape (6,), rad/s.

    Parameters
    ----------
    angle : array, shape (samples, 6), rad
    rate : float, samples/s
    smoothing : float, s
        As of the friction ranges.
    """
    return _fastest(smoothed_speeds(angle, rate, smoothing)[_gained(angle, rate) < STEADY])


def _gained(angle: np.ndarray, rate: float) -> np.ndarray:
    """Return how quickly any joint gains or loses speed, shape (samples,), rad/s^2; infinite at the ends."""
    look = max(1, round(0.5 * LOOK * rate))
    found = np.full(len(angle), np.inf)
    gained = np.abs(angle[2 * look :] - 2 * angle[look:-look] + angle[: -2 * look]) * (rate / look) ** 2
    found[look:-look] = gained.max(axis=1)
    return found


def _knots(speed: np.ndarray) -> np.ndarray:
    """Return speeds, shape (KNOTS, 6), rad/s, to the fastest that was seen both ways."""
    if len(speed) < 100 * KNOTS:
        raise SweepError(f"{len(speed)} samples are of steady motion, must be >= {100 * KNOTS}")
    fastest = _fastest(speed)
    slow = np.flatnonzero(~(fastest > 10 * FINEST))
    if len(slow):
        raise SweepError(
            f"joint {slow[0] + 1} turns both ways at {fastest[slow[0]]:.3g} rad/s only, must be > {10 * FINEST:g} rad/s"
        )
    return np.asarray(FINEST * np.sinh(np.linspace(-1, 1, KNOTS)[:, None] * np.arcsinh(fastest / FINEST)))


def _fastest(speed: np.ndarray) -> np.ndarray:
    return np.asarray(np.clip(np.minimum(speed.max(axis=0), -speed.min(axis=0)), 0.0, None))


def _gravity(
    arm: Arm, angle: np.ndarray, torque: np.ndarray, speed: np.ndarray, knots: np.ndarray, used: np.ndarray
) -> tuple[Gravity, int]:
    """Fit gravity beside any friction that depends on speed alone; `used`, (samples, 6), is where joints slide."""
    parts: list[np.ndarray] = []
    few = np.flatnonzero(used.any(axis=1))[::SMOOTH]
    regressor = gravity_regressor(arm, angle[few])
    for joint in range(6):
        here = used[few, joint]
        if here.sum() < FEWEST * KNOTS:
            found, least = SMOOTH * here.sum(), SMOOTH * FEWEST * KNOTS
            raise SweepError(f"joint {joint + 1} slides steadily in {found} samples, must be >= {least}")
        both = np.column_stack([regressor[here, joint], torque[few][here, joint]])
        parts.append(beside_friction(both, speed[few][here, joint], knots[:, joint]))
    moments, told = np.zeros(24), 0
    for _ in range(2):  # each joint weighs by what it leaves, at first by all
        left = [max(float(np.std(both[:, -1] - both[:, :-1] @ moments)), 1e-9) for both in parts]
        both = np.concatenate([part / size for part, size in zip(parts, left, strict=True)])
        moments, told = smallest_moments(both[:, :-1], both[:, -1])
    return Gravity(moments.reshape(6, 4)), told


def _noise(friction: np.ndarray, used: np.ndarray, width: int) -> np.ndarray:
    """Return the covariance of what is left of torques by their mean over `width` samples, (6, 6), (N m)^2."""
    if used.sum() < 10 * width:
        raise SweepError(f"in {used.sum()} samples all joints slide at once, must be >= {10 * width}")
    left = (friction - _means(friction, width))[used]
    floor = 1e-6 * np.ptp(friction, axis=0)
    return np.asarray(width / (width - 1) * left.T @ left / len(left) + np.diag(floor**2))


def _means(signals: np.ndarray, width: int) -> np.ndarray:
    """Return means over `width` samples around each, shortened at the ends."""
    sums = np.concatenate([np.zeros((1, signals.shape[1])), np.cumsum(signals, axis=0)])
    at = np.arange(len(signals))
    start, end = np.maximum(at - width // 2, 0), np.minimum(at + (width + 1) // 2, len(signals))
    return np.asarray((sums[end] - sums[start]) / (end - start)[:, None])


def _ranges(
    friction: np.ndarray, speed: np.ndarray, knots: np.ndarray, left_out: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the lowest and highest friction at the knots, (KNOTS, 6), N m: over its cell and its neighbours'."""
    bounds = np.full((2, KNOTS, 6), np.nan)
    for joint in range(6):
        cell = np.searchsorted(0.5 * (knots[1:, joint] + knots[:-1, joint]), speed[:, joint])
        for knot in range(KNOTS):
            seen = friction[cell == knot, joint]
            if len(seen) >= FEWEST:
                bounds[:, knot, joint] = np.quantile(seen, [left_out, 1 - left_out])
        known = np.isfinite(bounds[0, :, joint])
        for side in range(2):
            bounds[side, :, joint] = np.interp(knots[:, joint], knots[known, joint], bounds[side, known, joint])
    padded = np.pad(bounds, ((0, 0), (1, 1), (0, 0)), mode="edge")
    beside = np.stack([padded[:, :-2], padded[:, 1:-1], padded[:, 2:]])
    return beside[:, 0].min(axis=0), beside[:, 1].max(axis=0)


def _fit(
    found: FrictionRange, weight: np.ndarray, torque: np.ndarray, smooth: np.ndarray, speed: np.ndarray,
    slides: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:  # fmt: skip
    """Judge gravity's `weight` and friction by validation motions: fit, share inside, residual."""
    bounds = found.at(speed)
    known = np.isfinite(bounds).all(axis=(1, 2))
    fit, inside, residual = np.empty((3, 6))
    for joint in range(6):
        low, high = bounds[known, :, joint].T
        seen = smooth[known, joint]
        inside[joint] = np.mean((seen >= low) & (seen <= high))
        here = known & slides[:, joint]
        left = torque[here, joint] - weight[here, joint] - bounds[here, :, joint].mean(axis=1)
        residual[joint] = np.sqrt(np.mean(left**2))
        fit[joint] = 1 - residual[joint] / np.std(torque[here, joint])
    return fit, inside, residual
