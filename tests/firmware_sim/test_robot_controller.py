"""The robot's controller cycle by cycle, and a client of somebody else's making on the wire."""

import socket

import numpy as np
import pytest

from firmware_sim.plants.robot import RobotPlant
from firmware_sim.robot_controller import GuidedMotion, RobotController
from firmware_sim.robot_inverse import rigid_pose, toward
from firmware_sim.wire_ends import EgmEnd
from stagectl.robot.config import CellConfig, Robot
from stagectl.robot.kinematics import forward
from stagectl.robot.port import arm_of
from stagectl.wire.egm import pack_command, unpack_report
from stagectl.wire.robot import RATE, Command, Motion


def controller(**setup: float) -> RobotController:
    return RobotController(RobotPlant(seed=2, noise=0.0), GuidedMotion(**setup), end=EgmEnd())  # type: ignore[arg-type]


def ask(robot: RobotController, counter: int, angle: np.ndarray) -> None:
    robot.receive(pack_command(Command(counter, 0.0, joint_angle=angle)))


@pytest.mark.parametrize("name", ["irb140", "kuka"])
def test_its_geometry_is_that_of_the_program(name: str) -> None:
    """Written twice, apart from each other."""
    plant, rng = RobotPlant(arm=name, tool=0.0), np.random.default_rng(3)
    arm = arm_of(CellConfig(robot=Robot(arm=name)))
    for angle in rng.uniform(-1, 1, (10, 6)):
        np.testing.assert_allclose(rigid_pose(plant, angle)[:3], forward(arm, angle)[:3, 3], atol=1e-14)


def test_it_follows_with_a_lag_of_10_to_20_milliseconds() -> None:
    """Of its reference behind a ramp: two cycles and the filter's time constant."""
    robot = controller(speed=10.0)
    home, speed, planned = robot.plant.home, 0.05, []
    for cycle in range(1, 101):
        ask(robot, cycle, home + speed * cycle / RATE)
        report = robot.advance()
        assert report is not None
        planned.append(unpack_report(report).planned_angle[0] - home[0])
    lag = 100 / RATE - planned[-1] / speed
    assert 0.010 < lag < 0.020


def test_its_cycle_goes_on_without_commands_and_stops_after_its_patience() -> None:
    robot = controller(patience=0.1)
    ask(robot, 1, robot.plant.home + 1e-3)
    said = [unpack_report(robot.advance() or b"") for _ in range(40)]
    assert [each.counter for each in said[:3]] == [2, 3, 4] or said[0].counter == 1
    assert [each.motion for each in said].index(Motion.STOPPED) == 25
    ask(robot, 2, robot.plant.home + 2e-3)
    assert unpack_report(robot.advance() or b"").motion is Motion.STOPPED
    assert robot.do("RESET") == "OK"
    assert unpack_report(robot.advance() or b"").motion is Motion.RUNNING


def test_it_refuses_rubbish_old_commands_and_far_ones() -> None:
    robot = controller()
    home = robot.plant.home
    robot.receive(b"rubbish")
    ask(robot, 5, home)
    ask(robot, 5, home)
    ask(robot, 3, home)
    assert (robot.counts.garbled, robot.counts.taken, robot.counts.late) == (1, 1, 2)
    ask(robot, 6, home + 1.0)
    assert unpack_report(robot.advance() or b"").motion is Motion.ERROR
    for _ in range(50):
        robot.advance()
    assert np.abs(robot.motor_angle - home).max() < 1e-4


def test_a_pose_moves_the_rigid_arms_tool_there() -> None:
    robot = controller()
    pose = rigid_pose(robot.plant, robot.plant.home)
    pose[:3] += 2e-3, -1e-3, 1.5e-3
    np.testing.assert_allclose(rigid_pose(robot.plant, toward(robot.plant, robot.plant.home, pose)), pose, atol=1e-7)
    for cycle in range(1, 500):
        robot.receive(pack_command(Command(cycle, 0.0, pose=pose)))
        report = robot.advance()
    assert report is not None
    np.testing.assert_allclose(unpack_report(report).pose[:3], pose[:3], atol=5e-5)


def test_its_program_softens_clamps_and_says_why_not() -> None:
    robot = controller()
    assert robot.do("SOFT 0.5 0 0 0 0 0.9") == "OK"
    assert robot.do("CLAMP 1") == "OK"
    assert robot.do("CLAMP 0") == "OK"
    assert robot.do("SOFT 0.5 0 0").startswith("ERROR softness")
    assert robot.do("SOFT a b c d e f").startswith("ERROR could not convert")
    assert robot.do("DANCE") == "ERROR 'DANCE' is none of SOFT, CLAMP, BLOCK, RESET"


def test_its_signals_are_angles_in_degrees_and_torques() -> None:
    robot = controller()
    robot.advance()
    values = [float(each) for each in robot.signal().split(",")]
    assert values[0] == pytest.approx(1 / RATE)
    np.testing.assert_allclose(np.radians(values[1:7]), robot.motor_angle[0], atol=1e-8)
    np.testing.assert_allclose(values[7:], robot.torque[0], rtol=1e-7)


def test_supervision_is_told_to_the_host() -> None:
    robot = controller()
    robot.plant.trip(2)
    report = unpack_report(robot.advance() or b"")
    assert (report.motors_on, report.motion) == (False, Motion.STOPPED)


def test_another_client_guides_it_over_udp() -> None:
    """ABBRobotEGM, some hundred cycles over loopback: what it reads is what was said, what it asks for is done."""
    package = pytest.importorskip("ABBRobotEGM", reason="ABBRobotEGM is not installed")
    robot, home = controller(), RobotPlant(seed=2).home
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as line, package.EGM(port=0) as client:
        line.bind(("127.0.0.1", 0))
        line.settimeout(2.0)
        to = ("127.0.0.1", client.socket.getsockname()[1])
        for cycle in range(300):
            line.sendto(robot.advance() or b"", to)
            heard, state = client.receive_from_robot(2.0)
            assert heard
            assert state.header.seqno == robot.cycle
            np.testing.assert_allclose(state.joint_angles, np.degrees(robot.motor_angle[0]), atol=1e-9)
            assert client.send_to_robot(np.degrees(home + 1e-3 * min(cycle / 100, 1.0)))
            robot.receive(line.recv(65_536))
    assert robot.counts.taken == 300
    assert np.abs(robot.motor_angle[0] - home - 1e-3).max() < 2e-4
