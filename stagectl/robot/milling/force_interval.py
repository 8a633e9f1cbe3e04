"""Between which limits the force on the tool is with 95 %, from torques whose friction is as likely as it was seen."""

from dataclasses import dataclass

import numpy as np

from stagectl.robot.kinematics import jacobian
from stagectl.robot.milling.force_estimate import ForceEstimates
from stagectl.robot.milling.force_margin import FADE
from stagectl.robot.milling.force_model import ForceModel

NORMAL = 1.96
"""Standard deviations on either side that hold 95 % of a normal distribution."""
UNIFORM = 3.0**-0.5
"""Standard deviation of a uniform distribution, over its half width."""
MOMENT = 0.5
"""Standard deviation of a joint's part of the moment, over the largest moment that a margin has."""


@dataclass(frozen=True, eq=False)
class ForceIntervals:
    """Intervals of 95 % of the force's mean since the sample before, axis by axis, in the base.

    Parameters
    ----------
    low, high : arrays, shape (samples, 3), N
        Within the bounds; infinite where nothing is determined.
    """

    low: np.ndarray
    high: np.ndarray


def force_intervals(
    model: ForceModel, found: ForceEstimates, joint_angle: np.ndarray, torque: np.ndarray, rate: float
) -> ForceIntervals:
    """Return intervals by generalized least squares, cut off at the bounds.

    A joint's torque beside gravity and force has the middle of its friction range, and about that: friction, evenly
    within the range; noise, of R_e; inertia times the largest acceleration lately; a moment.  All are independent from
    joint to joint, but not from sample to sample: what is off in one sample is off as much in the next.  The force is
    that which comes to the motors: what is faster than some 10 Hz is taken by the arm's own mass.

    Parameters
    ----------
    model : ForceModel
    found : ForceEstimates
        What `model.estimate` returns for the same record.
    joint_angle : array, shape (samples, 6), rad
    torque : array, shape (samples, 6), N m
    rate : float, samples/s

    Source
    ------
    Aitken, Proc. R. Soc. Edinburgh 55 (1936) 42, for (5.5) of Sornmo 2015.
    """
    speed = model.friction.speeds(joint_angle, rate)
    ranges = model.friction.at(speed)
    told = np.isfinite(found.force).all(axis=1) & np.isfinite(ranges).all(axis=(1, 2))
    low, high = found.low.copy(), found.high.copy()
    if not told.any():
        return ForceIntervals(low, high)
    angle, ranges = joint_angle[told], ranges[told]
    half = 0.5 * (ranges[:, 1] - ranges[:, 0])
    inertia = model.inertia * _accelerations(joint_angle, speed, rate)[told]
    covariance = np.tile(model.friction.covariance, (len(half), 1, 1))
    own = (UNIFORM * half) ** 2 + (MOMENT * model.margin.moment) ** 2 + inertia**2
    covariance[:, range(6), range(6)] += own
    lever = jacobian(model.arm, angle)[:, :3]
    weighed = lever @ np.linalg.inv(covariance)
    spread = np.linalg.inv(weighed @ lever.swapaxes(1, 2))
    left = torque[told] - model.gravity.torque(model.arm, angle) - ranges.mean(axis=1)
    force = -(spread @ weighed @ left[..., None])[..., 0]
    reach = NORMAL * np.sqrt(np.diagonal(spread, axis1=1, axis2=2))
    low[told], high[told] = (np.clip(each, low[told], high[told]) for each in (force - reach, force + reach))
    return ForceIntervals(low, high)


def _accelerations(joint_angle: np.ndarray, speed: np.ndarray, rate: float) -> np.ndarray:
    """Return the largest acceleration lately, which fades as in a margin, shape (samples, 6), rad/s^2."""
    gained = np.abs(np.diff(speed, axis=0, prepend=0.0)) * rate
    gained[~np.isfinite(joint_angle)] = 0.0
    aged = np.arange(len(gained))[:, None] / (FADE * rate)
    with np.errstate(divide="ignore"):
        return np.asarray(np.exp(np.maximum.accumulate(np.log(gained) + aged, axis=0) - aged))
