"""How much friction there may be in a joint at a speed: a band of torques for each, and the noise around it."""

from dataclasses import dataclass

import numpy as np

from stagectl.robot.milling import torque_kernel as kernel


@dataclass(frozen=True, eq=False)
class FrictionRange:
    """Lowest and highest friction over speed, and the noise of the torque signals.

    Friction opposes the motors where its torque has the sign of the speed.  Near rest a range spans both signs.

    Parameters
    ----------
    speed : array, shape (knots, 6), rad/s, rising
        From the fastest backward to the fastest forward motion that was seen of each joint.
    low, high : array, shape (knots, 6), N m
        Straight between the knots.
    covariance : array, shape (6, 6), (N m)^2
        R_e, of a single sample.
    smoothing : float, s, >= 0
        Time constant of the low-pass behind which speeds were seen, and are to be seen.

    Raises
    ------
    ValueError : shapes that do not fit, speeds that do not rise or do not reach both ways, an empty range, a
        covariance that is not positive definite.
    """

    speed: np.ndarray
    low: np.ndarray
    high: np.ndarray
    covariance: np.ndarray
    smoothing: float

    def __post_init__(self) -> None:
        """Refuse what cannot be."""
        knots = len(self.speed)
        for name, shape in (("speed", (knots, 6)), ("low", (knots, 6)), ("high", (knots, 6)), ("covariance", (6, 6))):
            value = np.asarray(getattr(self, name))
            if value.shape != shape or not np.isfinite(value).all():
                raise ValueError(f"{name} has shape {value.shape}, must be {shape} and finite")
        if not (knots >= 2 and (np.diff(self.speed, axis=0) > 0).all()):
            raise ValueError(f"speed has {knots} knots, must have 2 at least, which rise")
        if not ((self.speed[0] < 0) & (self.speed[-1] > 0)).all():
            raise ValueError(f"speed goes from {self.speed[0]} to {self.speed[-1]} rad/s, must reach both ways")
        if not (self.low < self.high).all():
            knot, joint = np.argwhere(~(self.low < self.high))[0]
            raise ValueError(
                f"friction of joint {joint + 1} at {self.speed[knot, joint]:g} rad/s: {self.low[knot, joint]:g} to "
                f"{self.high[knot, joint]:g} N m, must rise"
            )
        if not np.linalg.eigvalsh(self.covariance).min() > 0:
            raise ValueError("covariance must be positive definite")
        if not 0 <= self.smoothing < np.inf:
            raise ValueError(f"smoothing is {self.smoothing} s, must be >= 0 and finite")

    def at(self, speed: np.ndarray) -> np.ndarray:
        """Return lowest and highest friction, shape (samples, 2, 6), N m; NaN where any speed is beyond the knots.

        Parameters
        ----------
        speed : array, shape (samples, 6), rad/s
        """
        found = np.empty((len(speed), 2, kernel.JOINTS))
        kernel.friction_ranges(np.ascontiguousarray(speed, float), self.speed, self.bounds, found)
        return found

    @property
    def bounds(self) -> np.ndarray:
        """Lowest and highest friction at the knots, shape (2, knots, 6), N m."""
        return np.stack([self.low, self.high])

    def speeds(self, joint_angle: np.ndarray, rate: float) -> np.ndarray:
        """Return the speeds at which friction is to be read, shape (samples, 6), rad/s, causal; a gap begins anew.

        Parameters
        ----------
        joint_angle : array, shape (samples, 6), rad
        rate : float, samples/s
        """
        return smoothed_speeds(joint_angle, rate, self.smoothing)


def smoothed_speeds(joint_angle: np.ndarray, rate: float, smoothing: float) -> np.ndarray:
    """Return differences of angles behind a first-order low-pass, shape (samples, 6), rad/s.

    Parameters
    ----------
    joint_angle : array, shape (samples, 6), rad
    rate : float, samples/s
    smoothing : float, s
        Its time constant; 0 for none.
    """
    found = np.empty(joint_angle.shape)
    kernel.follow_speeds(np.ascontiguousarray(joint_angle, float), speed_pole(smoothing, rate), rate, found)
    return found


def speed_pole(smoothing: float, rate: float) -> float:
    """Return the pole of that low-pass."""
    return float(np.exp(-1.0 / (smoothing * rate))) if smoothing > 0 else 0.0
