"""What may go to the robot, and how it stops."""

import numpy as np
import pytest

from stagectl.robot.arm import irb140
from stagectl.robot.config import RobotLimits
from stagectl.robot.guard import CommandGuard
from stagectl.robot.guard_kernel import flange
from stagectl.robot.kinematics import forward, jacobian

HOME = np.radians([0.0, 0.0, 0.0, 0.0, 30.0, 0.0])
POSE = np.array([0.5, 0.0, 0.7, 1.0, 0.0, 0.0, 0.0])


def guard(mode: str = "joints") -> CommandGuard:
    made = CommandGuard(irb140(), RobotLimits(), mode)
    made.place(HOME if mode == "joints" else POSE)
    made.release()
    return made


def test_its_geometry_is_that_of_the_kinematics() -> None:
    arm, rng = irb140(), np.random.default_rng(1)
    chain, found = np.stack([arm.offset, arm.d, arm.a, arm.alpha], axis=1), np.zeros((3, 4))
    for angle in rng.uniform(-1, 1, (10, 6)):
        flange(angle, chain, 0.0, found)
        np.testing.assert_allclose(found, forward(arm, angle)[:3], atol=1e-14)


def test_what_is_within_the_limits_goes_out_unchanged() -> None:
    made = guard()
    wanted = HOME + 1e-4
    assert made.take(HOME, wanted) == ""
    np.testing.assert_array_equal(made.sent, wanted)


def test_a_correction_beyond_a_millimetre_is_held_by_name() -> None:
    """The joints' limits of speed are as wide as can be here: it is the correction that is too large."""
    limits = RobotLimits(speed=1.0, tool_speed=5.0)
    away = np.linalg.solve(jacobian(irb140(), HOME), [1.0, 0, 0, 0, 0, 0])
    for size, fine in ((0.99e-3, True), (1.02e-3, False)):
        made = CommandGuard(irb140(), limits, "joints")
        made.place(HOME)
        made.release()
        reason = made.take(HOME, HOME + size * away)
        assert (reason == "") is fine
        assert fine or "the correction moves the tool by 1.0" in reason
        assert made.is_holding is not fine


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (np.full(6, np.nan), "the reference of joint 1 is nan, must be a number"),
        (np.array([0, 0, np.inf, 0, 0, 0]), "the reference of joint 3 is inf"),
        (np.array([0, 0, 0, 0.5, 0, 0]), "joint 4 is asked to turn by 7162 deg/s, must be <= 36 deg/s"),
        (np.array([0, 0, 0, 0, 1.6, 0]), "joint 5 is asked to 121.7 deg, must stay within 113 deg"),
    ],
)
def test_each_limit_is_named(change: np.ndarray, words: str) -> None:
    made = guard()
    assert words in made.take(HOME + change, HOME + change)
    np.testing.assert_array_equal(made.sent, HOME)
    assert made.is_holding


def test_the_tool_is_kept_slow_and_in_its_box() -> None:
    made = guard("pose")
    assert "move at 0.5 m/s" in made.take(POSE + 0.002 * np.eye(7)[0], POSE + 0.002 * np.eye(7)[0])
    made = guard("pose")
    high = POSE.copy()
    high[2] = 1.4999
    made.place(high)
    assert "asked to z = 1.501 m, must stay within 1.5 m" in made.take(
        high + 0.0009 * np.eye(7)[2], high + 0.0009 * np.eye(7)[2]
    )
    made = guard("pose")
    turned = np.array([*POSE[:3], np.cos(0.005), 0.0, np.sin(0.005), 0.0])
    assert "the tool is asked to turn by" in made.take(turned, turned)


def test_a_pose_may_be_sent_with_a_correction_of_less_than_a_millimetre() -> None:
    made = guard("pose")
    for n in range(1, 11):
        assert made.take(POSE, POSE + 9e-5 * n * np.eye(7)[1]) == ""
    assert "must be <= 1 mm" in made.take(POSE, POSE + 1.1e-3 * np.eye(7)[1])


@pytest.mark.parametrize("mode", ["joints", "pose"])
def test_a_hold_comes_to_rest_and_stays(mode: str) -> None:
    made = guard(mode)
    start = made.sent.copy()
    for n in range(1, 50):
        wanted = start + 2e-5 * n * np.eye(made.width)[0]
        assert made.take(wanted, wanted) == ""
    made.hold()
    path = []
    for _ in range(60):
        made.rest()
        path.append(made.sent[0])
    steps = np.diff([wanted[0], *path])
    assert (steps >= 0).all()
    assert (np.diff(steps) <= 1e-15).all()
    assert steps[25] < 0.02 * 2e-5
    assert path[-1] - wanted[0] < 2e-4


def test_a_hold_near_a_limit_does_not_pass_it() -> None:
    made = guard()
    top = irb140().high[0] - RobotLimits().margin
    start = HOME.copy()
    start[0] = top - 1e-3
    made.place(start)
    start[0] = top - 1e-4
    assert made.take(start, start) == ""
    made.hold()
    for _ in range(20):
        made.rest()
    assert made.sent[0] == pytest.approx(top)
