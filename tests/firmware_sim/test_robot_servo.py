"""The simulated robot's servo, its supervision, and the clamp that may hold its tool."""

import numpy as np
import pytest

from firmware_sim.plants.robot import STIFF_CLAMP, RobotPlant
from firmware_sim.plants.robot_joint_kernel import STIFF_PLUS
from tests.firmware_sim.robot_runs import held, run


def test_it_follows_a_slow_reference_and_comes_to_rest() -> None:
    plant = RobotPlant(seed=1)
    time = np.arange(750) / 250.0
    reference = plant.home + 0.05 * (1 - np.cos(np.pi * np.minimum(time, 2.0) / 2))[:, None]
    angle, torque, *_ = run(plant, reference)
    assert np.abs(angle - reference).max() < 4e-3
    assert np.abs(angle[-50:] - reference[-50:]).max() < 2e-4
    assert np.ptp(torque[-50:], axis=0).max() < 5.0


def test_soft_servo_yields_to_a_push_and_comes_back_stiff() -> None:
    plant = RobotPlant(seed=1, friction=0.2)
    push = np.array([0.0, 60.0, 0.0, 0.0, 0.0, 0.0])
    stiff = held(plant, push, 2.0)[0][-1, 0] - plant.home[0]
    plant.soften(np.array([0.95, 0, 0, 0, 0, 0]))
    soft = held(plant, push, 3.0)[0][-1, 0] - plant.home[0]
    plant.soften(np.zeros(6))
    again = held(plant, push, 3.0)[0][-1, 0] - plant.home[0]
    assert max(abs(stiff), abs(again)) < 2e-4
    assert soft > 5e-3


def test_supervision_puts_the_brakes_on_and_names_the_joint() -> None:
    plant = RobotPlant(seed=1)
    plant.clamp()
    reference = np.tile(plant.home, (500, 1))
    reference[:, 2] += np.linspace(0.0, 0.2, 500)
    angle, torque, *_ = run(plant, reference)
    assert plant.tripped == 3
    assert np.ptp(angle[-50:, 2]) < 1e-4
    assert np.abs(torque[-1, 2]) < 2.0
    plant.brake(False)
    assert plant.tripped == 0


@pytest.mark.parametrize("orthogonal", [0.0, 1.0])
def test_a_clamped_joint_shows_its_spring_in_series_with_what_holds_the_tool(orthogonal: float) -> None:
    """A motor pushes against its gear: alone where nothing else yields; softer where the joints tilt and the clamp."""
    plant = RobotPlant(seed=6, orthogonal=orthogonal, backlash=0.0, friction=0.0, noise=0.0)
    plant.clamp(STIFF_CLAMP if orthogonal else 1e-3 * STIFF_CLAMP)
    reference = np.tile(plant.home, (500, 1))
    seen = []
    for offset in (0.001, 0.002):
        reference[:, 0] = plant.home[0] + offset
        motor, torque, link, _ = run(plant, reference)
        seen.append((motor[-1, 0], torque[-1, 0], link[-1, 0]))
    motor_step, torque_step, link_step = np.diff(seen, axis=0)[0]
    across = abs(torque_step) / (motor_step - link_step)
    assert across == pytest.approx(plant.joints[STIFF_PLUS, 0], rel=1e-3)
    shown = torque_step / motor_step / plant.joints[STIFF_PLUS, 0]
    assert (shown == pytest.approx(1.0, rel=2e-3)) if orthogonal == 0.0 else 0.5 < shown < 0.98


def test_a_clamp_that_closes_pulls_at_nothing() -> None:
    """Gravity has tilted the joints before: the tool is held as it is, not where a rigid arm would have it."""
    plant = RobotPlant(seed=6, noise=0.0, orthogonal=5.0)
    before = held(plant, np.zeros(6))
    plant.clamp()
    after = held(plant, np.zeros(6))
    assert np.abs(after[1] - before[1][-1]).max() < 0.5
    assert np.abs(after[3][:, :3] - before[3][-1, :3]).max() < 2e-6


def test_a_clamp_slips_beyond_its_force() -> None:
    plant = RobotPlant(seed=6)
    plant.clamp(slip_force=50.0)
    reference = np.tile(plant.home, (500, 1))
    reference[:, 0] += np.linspace(0.0, 0.05, 500)
    run(plant, reference)
    assert 0.01 < plant.slipped < 0.04
    plant.release()
    assert np.abs(run(plant, reference[-1:].repeat(500, 0))[0][-1] - reference[-1]).max() < 1e-3
