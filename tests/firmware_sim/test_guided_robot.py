"""The simulated robot under guided motion: its lag, its reports, its gears, and what goes wrong with it."""

import numpy as np
import pytest

from firmware_sim.guided_robot import GuidedRobot
from firmware_sim.plants.gear_error import LARGEST, draw_gear_error

RATE = 2_000.0


def run(robot: GuidedRobot, reference: np.ndarray) -> list[np.ndarray]:
    frames = len(reference)
    robot.prepare(RATE, frames)
    outputs = [np.empty((frames, port.width)) for port in robot.outputs]
    robot.process(reference, np.zeros((frames, 3)), np.zeros((frames, 3)), *outputs)
    return outputs


def home(robot: GuidedRobot, frames: int) -> np.ndarray:
    robot.prepare(RATE, frames)
    return np.tile(robot.plant.home, (frames, 1))


def test_it_reports_250_times_a_second_and_stands_where_it_starts() -> None:
    robot = GuidedRobot(arm="kuka", noise=0.0)
    report, motors, angle, planned, position, _, torque, _ = run(robot, home(robot, 400))
    np.testing.assert_array_equal(report[:, 0], 1 + np.arange(400) // 8)
    np.testing.assert_allclose(planned, home(robot, 400), atol=1e-12)
    np.testing.assert_allclose(angle, planned, atol=5e-6)
    assert np.ptp(position, axis=0).max() < 5e-6
    assert motors.min() == 1.0
    np.testing.assert_array_equal(torque[1:8], np.tile(torque[0], (7, 1)))
    assert np.ptp(torque[8:], axis=0).max() > 0.0


def test_it_follows_a_ramp_10_to_20_ms_later() -> None:
    robot = GuidedRobot(arm="kuka", noise=0.0)
    reference = home(robot, 1_200)
    reference[:, 0] += 0.05 * np.arange(1_200) / RATE
    planned = run(robot, reference)[3]
    assert 0.010 < (reference[-1, 0] - planned[-1, 0]) / 0.05 < 0.024  # a report is up to 4 ms old


def test_gears_are_off_by_up_to_an_arc_minute_from_end_to_end() -> None:
    """While nothing of it shows on the motors."""
    gears = draw_gear_error(3, 1.0)
    assert 0.5 * LARGEST <= gears[:, 0].sum(axis=0).min() <= gears[:, 0].sum(axis=0).max() <= LARGEST
    exact, real = GuidedRobot(gear_error=0.0, noise=0.0, seed=3), GuidedRobot(noise=0.0, seed=3)
    reference = home(exact, 1_600)
    reference[:, 0] += 0.04 * np.arange(1_600) / 1_600
    parts = run(exact, reference), run(real, reference)
    assert np.abs(parts[0][2] - parts[1][2]).max() < 2e-5
    apart = (parts[1][4] - parts[0][4])[:, 1]
    assert 0.2 * LARGEST * 0.5 < np.ptp(apart) < 4 * LARGEST * 0.8


def test_a_mute_robot_goes_on_moving_and_reports_nothing_new() -> None:
    robot = GuidedRobot(arm="kuka", mute=0.1, mute_for=0.05)
    reference = home(robot, 500)
    reference[:, 0] += 0.02 * np.arange(500) / RATE
    report, _, angle, _, position, _, torque, _ = run(robot, reference)
    assert (
        np.ptp(report[200:300]) == 0.0 == np.ptp(angle[200:300], axis=0).max() == np.ptp(torque[200:300], axis=0).max()
    )
    assert report[304, 0] > report[299, 0]
    assert np.abs(position[299] - position[200]).max() > 1e-4


def test_its_motors_torque_answers_a_force_on_the_tool_through_the_jacobian() -> None:
    robot = GuidedRobot(noise=0.0, friction=0.0, start=(0.1, 0.2, -0.1, 0.3, 0.6, -0.2))
    force = np.zeros((2_000, 3))
    force[1_000:] = 30.0, -40.0, 20.0
    robot.prepare(RATE, 2_000)
    outputs = [np.empty((2_000, port.width)) for port in robot.outputs]
    robot.process(np.tile(robot.start, (2_000, 1)), force, np.zeros_like(force), *outputs)
    before, after = outputs[-2][999], outputs[-2][-400:].mean(axis=0)
    tool = robot.plant.frames[7][:, 3]
    axes = [(frame[:, 2], frame[:, 3]) for frame in robot.plant.frames[:6]]
    wanted = [-np.cross(axis, tool - origin) @ force[-1] for axis, origin in axes]
    np.testing.assert_allclose(after - before, wanted, atol=0.05)


def test_a_torque_supervision_that_trips_takes_the_motors_off() -> None:
    robot = GuidedRobot(arm="kuka", trip=0.1)
    motors = run(robot, home(robot, 400))[1][:, 0]
    assert motors[:200].min() == 1.0
    assert motors[210:].max() == 0.0


def test_an_option_out_of_range_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match="simulator.options.gear_error is 11.0, must be 0 to 10"):
        GuidedRobot(gear_error=11.0)
