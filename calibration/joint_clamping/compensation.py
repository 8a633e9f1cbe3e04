"""Motion of the arm's side in a clamp that gives way, from what can be measured or is known of it."""

from dataclasses import dataclass

import numpy as np

from stagectl.robot.arm import Arm
from stagectl.robot.kinematics import jacobian


def arm_motion_of_deflection(arm: Arm, joint_angle: np.ndarray, deflection: np.ndarray) -> np.ndarray:
    """Return how the joints' arm sides have moved, from the end effector's measured deflection.

    What the joints' bearings tilt is not in it: it accounts for a part only (the thesis found up to a half).

    Parameters
    ----------
    arm : Arm
    joint_angle : array, shape (joints,), rad
        The clamping pose.
    deflection : array, shape (samples, 6), m and rad
        Of the flange, in the axes of the base.

    Returns
    -------
    array, shape (samples, joints), rad

    Raises
    ------
    ValueError : a pose so near a singularity that the deflection says nothing of a joint.

    Source
    ------
    Sornmo 2015, eq. (4.1).
    """
    return np.asarray(deflection @ _inverse(arm, joint_angle).T)


def arm_motion_of_torque(arm: Arm, joint_angle: np.ndarray, compliance: np.ndarray, torque: np.ndarray) -> np.ndarray:
    """Return how the joints' arm sides have moved, from torques and the environment's known compliance.

    Parameters
    ----------
    arm : Arm
    joint_angle : array, shape (joints,), rad
        The clamping pose.
    compliance : array, shape (6, 6), m/N, rad/N, m/(N m), rad/(N m)
        Deflection of the flange per force and torque on it, in the axes of the base.
    torque : array, shape (samples, joints), N m
        Of all joints, without friction, which bears no force outside; see `spring_torque` of the joints' models.

    Returns
    -------
    array, shape (samples, joints), rad

    Raises
    ------
    ValueError : a compliance of another shape or not symmetric, or a pose near a singularity.

    Source
    ------
    Sornmo 2015, eqs. (4.2), (4.3), (4.4).
    """
    if compliance.shape != (6, 6) or not np.allclose(compliance, compliance.T, rtol=1e-6, atol=0):
        raise ValueError(f"a compliance has shape {compliance.shape}, must be (6, 6) and symmetric")
    inverse = _inverse(arm, joint_angle)
    return np.asarray(torque @ (inverse @ compliance @ inverse.T).T)


def _inverse(arm: Arm, joint_angle: np.ndarray) -> np.ndarray:
    """Invert the Jacobian, which must be far enough from singular for that to mean something."""
    matrix = jacobian(arm, joint_angle)
    weights = np.array([1.0, 1.0, 1.0, arm.reach, arm.reach, arm.reach])
    least = float(np.linalg.svd(weights[:, None] * matrix, compute_uv=False)[-1]) / arm.reach
    if not least > 1e-3:
        pose = ", ".join(f"{angle:.4g}" for angle in np.degrees(joint_angle))
        raise ValueError(f"the pose {pose} deg has a least singular value of {least:.2g} of the reach, must be > 0.001")
    inverse: np.ndarray = np.linalg.inv(matrix)
    return inverse


@dataclass(frozen=True)
class ActuationPlane:
    """The plane in which a joint turns, seen by a tracker, and the circle a point on the link goes along in it.

    Parameters
    ----------
    basis : array, shape (3, 2), 1
        Two directions in the plane; the angle goes from the first to the second, with the joint.
    centre : array, shape (3,), m
        Of the circle: on the joint's axis.
    radius : float, m
    """

    basis: np.ndarray
    centre: np.ndarray
    radius: float

    def angle(self, position: np.ndarray) -> np.ndarray:
        """Return the joint's angle, shape (samples,), rad, from positions of the point, shape (samples, 3), m.

        It counts from the direction of the first sample.
        """
        flat = (position - self.centre) @ self.basis
        return np.asarray(np.unwrap(np.arctan2(flat[:, 1], flat[:, 0])) - np.arctan2(flat[0, 1], flat[0, 0]))


def actuation_plane(position: np.ndarray, joint_angle: np.ndarray) -> ActuationPlane:
    """Find a joint's actuation plane from a calibration move of that joint alone, unclamped.

    Parameters
    ----------
    position : array, shape (samples, 3), m
        A tracked point of the joint's link, in the axes of the link before it.
    joint_angle : array, shape (samples,), rad
        Of the motor; says which way is positive.

    Raises
    ------
    ValueError : fewer than 10 samples, a move that does not span a plane, or no circle in it.

    Source
    ------
    Sornmo 2015, 4.3: the left singular vectors of the two largest singular values.

    Departs
    -------
    Centre and radius by least squares on the projected positions (Kasa 1976); the thesis does not say how.
    """
    if position.ndim != 2 or position.shape[1] != 3 or len(position) < 10:
        raise ValueError(f"positions have shape {position.shape}, must be (10 or more, 3)")
    mean = position.mean(axis=0)
    left, size, _ = np.linalg.svd((position - mean).T, full_matrices=False)
    if not size[1] > 3 * size[2]:
        raise ValueError(f"the move's singular values are {size[0]:.3g}, {size[1]:.3g}, {size[2]:.3g} m: no plane")
    basis = left[:, :2]
    flat = (position - mean) @ basis
    terms = np.column_stack([2 * flat, np.ones(len(flat))])
    (first, second, rest), *_ = np.linalg.lstsq(terms, np.sum(flat**2, axis=1), rcond=None)
    middle = np.array([first, second])
    around = np.unwrap(np.arctan2(*(flat - middle).T[::-1]))
    if np.ptp(around) == 0 or np.cov(around, joint_angle)[0, 1] < 0:
        basis, middle = basis * [1, -1], middle * [1, -1]
    return ActuationPlane(basis, mean + basis @ middle, float(np.sqrt(rest + middle @ middle)))
