"""The arm's whole stiffness, orthogonal compliances included, from clamping experiments in several poses."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import t as student

from calibration.joint_clamping.arm_compliance import joint_compliance, tilts
from calibration.joint_clamping.joint_model import CONFIDENCE, Estimate
from stagectl.robot.arm import Arm
from stagectl.robot.kinematics import jacobian

SAME = 1e-6
"""An effect on the flange that differs from a sum of others by less, relative, cannot be told from it."""

KNOWN = 0.5
"""A compliance with a larger relative standard error is called unknown."""


@dataclass(frozen=True)
class Clamping:
    """One joint actuated in one pose: how everything moved per torque of that joint, without friction.

    Parameters
    ----------
    pose : array, shape (joints,), rad
    joint : int
        Which was actuated, from 0.
    slope : array, shape (joints,), rad/(N m)
        Of all motor angles over the torque of the actuated joint; about 0 for joints that friction held.
    deflection : array, shape (6,), m/(N m) and rad/(N m)
        Of the flange over that torque, measured; zeros in a stiff clamp, or with `environment`.
    environment : array, shape (6, 6), SI
        The clamp's compliance if it is known and no deflection was measured.
    """

    pose: np.ndarray
    joint: int
    slope: np.ndarray
    deflection: np.ndarray = field(default_factory=lambda: np.zeros(6))
    environment: np.ndarray = field(default_factory=lambda: np.zeros((6, 6)))


@dataclass(frozen=True)
class ArmStiffness:
    """The compliances of an arm's joints.

    Parameters
    ----------
    own : tuple of Estimate, rad/(N m)
        About each joint's axis.
    tilting : tuple of (Estimate or None) pairs, rad/(N m)
        About the two axes of `tilts`; None where the poses do not tell it, or no pose does (`told_apart`): the others
        then contain it, and deflections of the flange are right all the same.
    misfit : float, 1
        Standard deviation of what is left of the torques, relative.
    """

    own: tuple[Estimate, ...]
    tilting: tuple[tuple[Estimate | None, Estimate | None], ...]
    misfit: float

    def stiffness(self, joint: int) -> float:
        """Return a joint's stiffness about its axis, N m/rad; joints count from 0."""
        return 1 / self.own[joint].value


def fit_stiffness(arm: Arm, experiments: Sequence[Clamping]) -> ArmStiffness:
    """Fit the compliances of all joints, own and orthogonal, to clamping experiments in several poses.

    Of each experiment one equation: the torque that the actuated joint needs for the motor angles as they were found.
    The other joints' torques, which friction hides, are not used.

    Parameters
    ----------
    arm : Arm
    experiments : sequence of Clamping
        At least as many as there are compliances to be told.

    Raises
    ------
    ValueError : too few experiments, or a joint that was never actuated.

    Source
    ------
    Sornmo 2015, 4.6 proposes it; the equation is that of `joint_compliance`, inverted.
    """
    free = told_apart(arm)
    never = set(range(arm.joints)) - {each.joint for each in experiments}
    if never:
        raise ValueError(f"joint {min(never) + 1} was never actuated, every joint must be")
    if len(experiments) <= free.sum():
        raise ValueError(f"there are {len(experiments)} experiments, must be more than {free.sum()} compliances")
    start = np.zeros(len(free))
    for joint in range(arm.joints):
        start[joint] = 0.8 * min(abs(each.slope[joint]) for each in experiments if each.joint == joint)
    start[arm.joints :] = 0.2 * start[: arm.joints].repeat(2)
    unit = start[free].copy()

    def left(scaled: np.ndarray) -> np.ndarray:
        compliance = np.zeros(len(free))
        compliance[free] = scaled * unit
        return np.array([_torque(arm, each, compliance) - 1.0 for each in experiments])

    found = least_squares(left, np.ones(len(unit)), x_scale="jac")
    return _stiffness(arm, free, found.x * unit, unit, found.jac, found.fun)


def _torque(arm: Arm, each: Clamping, compliance: np.ndarray) -> float:
    """Return the torque, per measured torque, that the actuated joint needs by the compliances."""
    own, tilting = compliance[: arm.joints], compliance[arm.joints :].reshape(-1, 2)
    whole = joint_compliance(arm, each.pose, own, tilting, each.environment)
    motion = each.slope - np.linalg.solve(jacobian(arm, each.pose), each.deflection)
    return float(np.linalg.solve(whole, motion)[each.joint])


def told_apart(arm: Arm) -> np.ndarray:
    """Return which compliances differ in what they do to the flange, shape (3 joints,): own first, then the tilts.

    Taken in that order, one that is a sum of others in every pose is left out: a joint's axis may lie in the plane in
    which a neighbour's bearing tilts.  Nothing outside the arm shows the difference.
    """
    each = _effects(arm)
    each /= np.linalg.norm(each, axis=0)
    told, basis = np.zeros(3 * arm.joints, bool), np.zeros((len(each), 0))
    for place in range(3 * arm.joints):
        rest = each[:, place] - basis @ (basis.T @ each[:, place])
        rest -= basis @ (basis.T @ rest)
        size = float(np.linalg.norm(rest))
        if size > SAME:
            told[place], basis = True, np.column_stack([basis, rest / size])
    return told


def as_told(arm: Arm, compliance: np.ndarray) -> np.ndarray:
    """Return the compliances that a perfect fit would find: those told apart, which contain the others.

    Parameters
    ----------
    arm : Arm
    compliance : array, shape (3 joints,), rad/(N m)
        True ones: own first, then the tilts, two a joint.

    Returns
    -------
    array, shape (3 joints,), rad/(N m)
        Zero where `told_apart` leaves one out.
    """
    told, effects = told_apart(arm), _effects(arm)
    found = np.zeros(len(told))
    found[told] = np.linalg.lstsq(effects[:, told], effects @ compliance, rcond=None)[0]
    return found


def _effects(arm: Arm) -> np.ndarray:
    """Return what each compliance does to the flange in some poses, shape (equations, 3 joints), m^2 and 1."""
    random = np.random.default_rng(0)
    effects = []
    for pose in random.uniform(np.maximum(arm.low, -np.pi), np.minimum(arm.high, np.pi), (8, arm.joints)):
        columns = np.concatenate([jacobian(arm, pose), tilts(arm, pose).reshape(6, -1)], axis=1)
        effects.append(columns[:, None] * columns[None])
    return np.concatenate(effects).reshape(-1, 3 * arm.joints)


def _stiffness(
    arm: Arm, free: np.ndarray, values: np.ndarray, unit: np.ndarray, sensitivity: np.ndarray, left: np.ndarray
) -> ArmStiffness:
    spare = len(left) - len(values)
    variance = float(left @ left) / spare
    covariance = variance * np.linalg.pinv(sensitivity.T @ sensitivity, rcond=1e-14, hermitian=True)
    errors, reach = np.sqrt(np.diag(covariance)) * unit, float(student.ppf(0.5 + CONFIDENCE / 2, spare))
    every: list[Estimate | None] = [None] * len(free)
    for place, value, error in zip(np.flatnonzero(free), values, errors, strict=True):
        known = place < arm.joints or error < KNOWN * abs(value)
        every[place] = Estimate(float(value), float(error), reach) if known else None
    own = tuple(each for each in every[: arm.joints] if each is not None)
    tilting = tuple((every[place], every[place + 1]) for place in range(arm.joints, len(free), 2))
    return ArmStiffness(own, tilting, float(np.sqrt(variance)))
