"""A clamp and bearings that give way: what each compensation gives back (Sornmo 2015, 4.5)."""

import numpy as np
import pytest

from calibration.joint_clamping.arm_compliance import joint_compliance, tilts
from calibration.joint_clamping.compensated import extract_compensated
from calibration.joint_clamping.compensation import (
    actuation_plane,
    arm_motion_of_deflection,
    arm_motion_of_torque,
)
from calibration.joint_clamping.extraction import extract
from calibration.joint_clamping.friction import friction_shape
from calibration.joint_clamping.full_stiffness import Clamping, as_told, fit_stiffness, told_apart
from calibration.joint_clamping.lever_arm import advise, candidate_poses
from calibration.joint_clamping.torque_map import TorqueMap, TorqueMapError
from stagectl.robot.arm import irb140
from stagectl.robot.kinematics import jacobian
from tests.calibration.joint_clamping.clamped_arm import RATE, ClampedArm, Joints, random_joints, to_and_fro

ARM = irb140()
POSE = np.radians([20.0, 30.0, -50.0, 25.0, 70.0, -30.0])
TABLE = np.diag([1.5e-7, 2e-7, 1e-7, 5e-7, 5e-7, 8e-7])
"""Compliance of a table, m/N and rad/(N m): 5 to 10 N/um."""
TRACKER = 60e-6
"""m, noise of one position."""


def bearings(parts: Joints, seed: int) -> np.ndarray:
    """Tilting of the bearings of joints 1 to 3, where the levers are long."""
    tilting = np.random.default_rng(seed).uniform(0.05, 0.25, (6, 2)) / parts.k_plus[:, None]
    tilting[3:] = 0.0
    return tilting


class Clamped:
    """One joint moved to and fro in a pose; `deflection` is that of the flange."""

    def __init__(self, parts: Joints, pose: np.ndarray, joint: int, tilting: np.ndarray, table: np.ndarray) -> None:
        inverse = np.linalg.inv(jacobian(ARM, pose))
        columns = tilts(ARM, pose).reshape(6, -1)
        whole = inverse @ (table + (columns * tilting.ravel()) @ columns.T) @ inverse.T
        plant = ClampedArm(parts, whole, seed=joint)
        self.angle, self.torque, self.arm = plant.run(to_and_fro(plant, joint))
        bears = np.linalg.solve(whole, self.arm.T).T
        self.bears, self.deflection = bears, bears @ inverse @ table
        self.map = TorqueMap(self.angle[:, joint], self.torque[:, joint], RATE)


@pytest.mark.slow
def test_uncorrected_it_is_underestimated_the_deflection_removes_a_part_and_the_link_leaves_3_percent() -> None:
    parts = random_joints(3)
    clamped = Clamped(parts, POSE, 0, bearings(parts, 3), TABLE)
    random = np.random.default_rng(1)
    measured = clamped.deflection + np.array([5e-6] * 3 + [2e-5] * 3) * random.standard_normal(clamped.deflection.shape)
    by_flange = extract_compensated(clamped.map, arm_motion_of_deflection(ARM, POSE, measured)[:, 0])
    by_link = extract_compensated(clamped.map, followed_link(clamped.arm[:, 0]))
    raw = extract(clamped.map)
    truth = parts.k_plus[0]
    assert raw.k_plus.high < 0.75 * truth
    assert 0.1 < (by_flange.k_plus.value - raw.k_plus.value) / (truth - raw.k_plus.value) < 0.8  # a part
    assert by_link.k_plus.value == pytest.approx(truth, rel=0.03)
    assert by_link.k_minus.value == pytest.approx(parts.k_minus[0], rel=0.03)
    assert by_link.k_plus.low < truth < by_link.k_plus.high
    assert by_link.backlash.value == pytest.approx(parts.backlash[0], rel=0.05)


@pytest.mark.slow
def test_a_motion_that_is_known_well_brings_what_other_joints_slide_against_their_friction() -> None:
    """Taken as a straight line, it would stay in the map as play."""
    parts = random_joints(3)
    clamped = Clamped(parts, POSE, 0, bearings(parts, 3), TABLE)
    sliding = 0.15e-3 * friction_shape(clamped.map.angle, 0.2 * float(np.ptp(clamped.map.angle)))
    moved = TorqueMap(clamped.map.angle + sliding, clamped.map.torque, RATE)
    found = extract_compensated(moved, clamped.arm[:, 0] + sliding)
    assert found.backlash.value == pytest.approx(parts.backlash[0], abs=0.005e-3)
    assert found.k_plus.value == pytest.approx(parts.k_plus[0], rel=0.01)


def followed_link(arm_angle: np.ndarray) -> np.ndarray:
    """Return the joint's angle as a tracker sees a point of the link, 0.35 m off the axis."""
    random = np.random.default_rng(2)
    first, second = np.linalg.qr(random.standard_normal((3, 3)))[0][:, :2].T

    def seen(angle: np.ndarray) -> np.ndarray:
        place = 0.35 * (np.cos(angle)[:, None] * first + np.sin(angle)[:, None] * second) + [1.0, 2.0, 0.5]
        return np.asarray(place + TRACKER * random.standard_normal(place.shape))

    sweep = np.linspace(-0.6, 0.7, 400)
    plane = actuation_plane(seen(sweep), sweep)
    assert plane.radius == pytest.approx(0.35, rel=1e-3)
    return plane.angle(seen(arm_angle))


@pytest.mark.slow
def test_a_known_compliance_of_the_environment_does_without_any_sensor() -> None:
    parts = random_joints(4)
    clamped = Clamped(parts, POSE, 1, np.zeros((6, 2)), TABLE)
    motion = arm_motion_of_torque(ARM, POSE, TABLE, clamped.bears)
    np.testing.assert_allclose(motion, arm_motion_of_deflection(ARM, POSE, clamped.deflection), atol=1e-12)
    assert extract(clamped.map).k_plus.value < 0.95 * parts.k_plus[1]
    found = extract_compensated(clamped.map, motion[:, 1])
    assert found.k_plus.value == pytest.approx(parts.k_plus[1], rel=0.02)


@pytest.mark.slow
def test_several_poses_give_the_bearings_tilting_within_10_percent() -> None:
    parts = random_joints(5, backlash=False)
    parts.k_minus[:] = parts.k_plus
    tilting, found = bearings(parts, 5), []
    for pose in long_poses(parts, tilting):
        found += [experiment(parts, pose, joint, tilting) for joint in range(6)]
    fitted = fit_stiffness(ARM, found)
    np.testing.assert_allclose([each.value * k for each, k in zip(fitted.own, parts.k_plus, strict=True)], 1, rtol=0.03)
    for joint, axis in np.ndindex(3, 2):
        said = fitted.tilting[joint][axis]
        assert said is not None, (joint, axis)
        assert said.value == pytest.approx(tilting[joint, axis], rel=0.1), (joint, axis)


def long_poses(parts: Joints, tilting: np.ndarray) -> list[np.ndarray]:
    """Return poses with long levers for one joint or another."""
    drawn = candidate_poses(ARM, 60, 7, 0.1)
    ranked = [advise(ARM, joint, drawn, 1 / parts.k_plus, tilting, TABLE) for joint in range(6)]
    return [each.pose for advice in ranked for each in advice[:2]]


def experiment(parts: Joints, pose: np.ndarray, joint: int, tilting: np.ndarray) -> Clamping:
    """Return what a static experiment shows, to 0.1 %: the other motors stand, held by their friction."""
    whole = joint_compliance(ARM, pose, 1 / parts.k_plus, tilting, TABLE)
    torque = np.linalg.solve(whole, np.eye(6)[joint])
    random = np.random.default_rng(int(1e6 * abs(pose[0])) + joint)
    off = 1 + 1e-3 * random.standard_normal(2)
    deflection = TABLE @ np.linalg.solve(jacobian(ARM, pose).T, torque)
    return Clamping(pose, joint, off[0] * np.eye(6)[joint] / torque[joint], off[1] * deflection / torque[joint])


def test_what_the_fit_leaves_out_moves_the_flange_as_sums_of_the_others_do() -> None:
    told = told_apart(ARM)
    assert told[:6].all()
    assert told[6:].reshape(6, 2)[:3].all()
    assert not told[6:].reshape(6, 2)[3:, 1].any()  # the axis of the joint before


def test_what_is_left_out_is_found_in_the_others() -> None:
    compliance = np.random.default_rng(4).uniform(1e-6, 1e-5, 18)
    found, told = as_told(ARM, compliance), told_apart(ARM)
    assert not found[~told].any()
    free = compliance * told
    np.testing.assert_allclose(as_told(ARM, free), free, rtol=1e-6)
    for pose in candidate_poses(ARM, 3, 5, 0.1):  # the flange moves as with the true ones
        columns = np.concatenate([jacobian(ARM, pose), tilts(ARM, pose).reshape(6, -1)], axis=1)
        true = (columns * compliance) @ columns.T
        np.testing.assert_allclose((columns * found) @ columns.T, true, atol=1e-6 * np.abs(true).max())


def test_too_few_experiments_or_a_joint_left_out_are_refused() -> None:
    parts = random_joints(5)
    one = [experiment(parts, POSE, joint, np.zeros((6, 2))) for joint in range(6)]
    with pytest.raises(ValueError, match="there are 6 experiments, must be more than 13"):
        fit_stiffness(ARM, one)
    with pytest.raises(ValueError, match="joint 3 was never actuated"):
        fit_stiffness(ARM, [each for each in one if each.joint != 2] * 4)


@pytest.mark.slow
def test_the_pose_that_is_advised_has_a_long_lever_and_shows_more_of_the_stiffness() -> None:
    parts = random_joints(6)
    advice = advise(ARM, 0, candidate_poses(ARM, 200, 1, 0.1), 1 / parts.k_plus, np.zeros((6, 2)), TABLE)
    assert advice[0].lever_arm > 0.6 > 0.3 > advice[-1].lever_arm
    for each in (advice[0], advice[len(advice) // 2]):
        clamped = Clamped(parts, each.pose, 0, np.zeros((6, 2)), TABLE)
        # others yield softly, so a little more or less than alone
        share = extract(clamped.map).k_plus.value / parts.k_plus[0]
        assert share == pytest.approx(each.measured_share, abs=0.1)


def test_an_arm_side_that_moves_as_far_as_the_motor_leaves_nothing() -> None:
    parts = random_joints(3)
    clamped = Clamped(parts, POSE, 0, np.zeros((6, 2)), 1e-3 * TABLE)
    with pytest.raises(TorqueMapError, match="nothing is left for the gear"):
        extract_compensated(clamped.map, clamped.map.angle)
    with pytest.raises(TorqueMapError, match=r"shape \(5,\), must be"):
        extract_compensated(clamped.map, np.zeros(5))


def test_a_move_that_spans_no_plane_is_refused() -> None:
    angle = np.linspace(0, 1, 50)
    with pytest.raises(ValueError, match="no plane"):
        actuation_plane(np.outer(angle, [1.0, 2.0, 3.0]) + 1e-6 * np.random.default_rng(1).normal(size=(50, 3)), angle)
    with pytest.raises(ValueError, match=r"shape \(5, 3\)"):
        actuation_plane(np.zeros((5, 3)), np.zeros(5))


def test_a_singular_pose_and_a_compliance_that_is_none_are_refused() -> None:
    with pytest.raises(ValueError, match="least singular value"):
        arm_motion_of_deflection(ARM, np.zeros(6), np.zeros((3, 6)))
    with pytest.raises(ValueError, match="must be \\(6, 6\\) and symmetric"):
        arm_motion_of_torque(ARM, POSE, np.triu(np.ones((6, 6))), np.zeros((3, 6)))
