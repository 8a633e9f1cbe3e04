"""Gravity's torques as a linear model."""

import numpy as np
import pytest

from firmware_sim.plants.robot import RobotPlant
from firmware_sim.plants.robot_joint_kernel import MOTOR
from stagectl.robot.kinematics import frames
from stagectl.robot.milling import torque_kernel
from stagectl.robot.milling.gravity import STANDARD_GRAVITY, gravity_regressor, packed_chain, smallest_moments
from tests.stagectl.robot.milling.torque_models import ARM, angles, some_gravity


def test_it_is_the_slope_of_the_potential_energy() -> None:
    gravity, angle = some_gravity(), angles(1)[0]

    def energy(at: np.ndarray) -> float:
        link = frames(ARM, at)[1:, 2, :]
        return float(STANDARD_GRAVITY * np.sum(link * gravity.moments))

    slopes = [(energy(angle + step) - energy(angle - step)) / 2e-6 for step in 1e-6 * np.eye(6)]
    assert gravity.torque(ARM, angle) == pytest.approx(slopes, abs=1e-6)


def test_the_kernel_gives_the_same_torques_and_levers() -> None:
    gravity, angle = some_gravity(), angles(20)
    expected = gravity.torque(ARM, angle)
    place, found = np.zeros((7, 3, 4)), np.zeros(6)
    for n in range(20):
        torque_kernel.place(angle[n], packed_chain(ARM), place)
        torque_kernel.carry(place, gravity.moments, STANDARD_GRAVITY, found)
        assert found == pytest.approx(expected[n], abs=1e-12)
        assert place[:, :3] == pytest.approx(frames(ARM, angle[n])[:, :3], abs=1e-14)


def test_moments_found_from_torques_hold_up_an_arm_in_poses_never_seen() -> None:
    """The simulated arm, whose mechanics are written apart, held up by its motors at rest; 10 combinations are told."""
    plant = RobotPlant(seed=4, payload=2.0)
    poses = np.random.default_rng(1).uniform(-0.8, 0.8, (60, 6))
    held = []
    for pose in poses:
        plant.place(pose)
        held.append(plant._arm["held"][0].copy())  # noqa: SLF001 (its motors' torques at rest)
        assert plant.state[MOTOR] == pytest.approx(pose)
    torque, regressor = np.array(held), gravity_regressor(ARM, poses)
    moments, told = smallest_moments(regressor[:40].reshape(-1, 24), torque[:40].ravel())
    assert told == 10
    assert regressor[40:] @ moments == pytest.approx(torque[40:], abs=0.2)  # gears wind up by milliradians
    assert np.abs(torque[40:]).max() > 50
