"""Gravity and friction ranges from a sweep of the simulated arm, whose mechanics are written apart."""

from pathlib import Path

import numpy as np
import pytest

from calibration.guided_arm import arm_with_tool
from calibration.milling.sweep_session import is_swept, sweep, sweep_steps
from calibration.milling.torque_fit import SweepError, TorqueFit, friction_and_gravity
from calibration.raw_run import raw_run
from ctlblocks.recording import Recording
from firmware_sim.plants.robot import RobotPlant
from firmware_sim.plants.robot_joint_kernel import (
    COULOMB,
    LINK_SPEED,
    MOTOR_SPEED,
    STICTION,
    STRIBECK,
    TORQUE_LIMIT,
    VISCOUS,
)
from rigkit.config import load
from rigkit.experiment.kept import records_of
from rigkit.experiment.once import PartEnded
from rigkit.experiment.runner import Conduct
from rigkit.stop import Stopped
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.friction_range import FrictionRange
from stagectl.robot.milling.gravity import Gravity

QUICK = ["friction.poses=7", "friction.seconds=3", "limits.tool_speed=0.6", "friction.creep=[0.03,0.006,0.06,0.015]"]
CELL = load(None, CellConfig, QUICK)


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    """Return the record of a short sweep of arm 1."""
    said: list[str] = []
    with raw_run(tmp_path_factory.mktemp("sweep"), CELL) as folder:
        made = sweep(CELL, False, folder, said.append, Conduct())
        assert len(said) == len(sweep_steps(CELL)) == 15
        assert sweep(CELL, False, folder, said.append, Conduct()).data.tobytes() == made.data.tobytes()
    assert len(said) == 15
    return made


Found = tuple[FrictionRange, Gravity, TorqueFit]


@pytest.fixture(scope="module")
def found(swept: Recording) -> Found:
    return friction_and_gravity(swept, arm_with_tool(CELL), CELL.friction)


@pytest.mark.slow
def test_ranges_hold_the_true_friction_and_noise_is_found(found: Found) -> None:
    friction, _, fit = found
    joints = RobotPlant(seed=1).joints
    fast = np.abs(friction.speed).min(axis=1) > 0.01
    speed, low, high = friction.speed[fast], friction.low[fast], friction.high[fast]
    drop = np.exp(-((speed / joints[STRIBECK]) ** 2))
    level = joints[COULOMB] + (joints[STICTION] - joints[COULOMB]) * drop
    true = np.sign(speed) * level + joints[VISCOUS] * speed
    slack = 0.2 * joints[COULOMB]  # gravity's own error
    assert (low - slack < true).all()
    assert (true < high + slack).all()
    assert (high - low < 0.9 * joints[COULOMB]).all()
    middle = len(friction.speed) // 2
    assert (friction.low[middle] < -0.7 * joints[COULOMB]).all()
    assert (friction.high[middle] > 0.7 * joints[COULOMB]).all()
    assert np.sqrt(np.diag(friction.covariance)) == pytest.approx(1e-3 * joints[TORQUE_LIMIT], rel=0.1)
    assert (fit.fit > 0.75).all()  # of the sixth, which bears nothing, noise is a quarter
    assert (fit.inside > 0.9).all()


@pytest.mark.slow
def test_gravity_is_found_without_any_drawing(found: Found) -> None:
    arm = arm_with_tool(CELL)
    _, gravity, fit = found
    plant = RobotPlant(seed=1)
    pose = np.radians([15.0, 10.0, -25.0, 30.0, 40.0, -20.0])
    plant.place(pose)
    held = plant._arm["held"][0]  # noqa: SLF001 (its motors' torques at rest)
    assert gravity.torque(arm, pose) == pytest.approx(held, abs=2.0)
    assert np.abs(held).max() > 40
    assert fit.combinations == 10


@pytest.mark.slow
def test_inertia_is_that_of_motors_and_links(swept: Recording, found: Found) -> None:
    """By the plant's own energy, half of inertia times speed squared, one joint at a time, over the poses."""
    _, _, fit = found
    plant, true = RobotPlant(seed=1), np.zeros(6)
    poses = swept.data[::1_000, :6].astype(float)
    for pose in poses:
        plant.place(pose)
        for joint in range(6):
            plant.state[[MOTOR_SPEED, LINK_SPEED]] = np.eye(6)[joint]
            true[joint] += 2 * plant.energy() / len(poses)
    assert fit.inertia == pytest.approx(true, rel=0.35)
    assert fit.inertia[:3] == pytest.approx(true[:3], rel=0.25)


def test_a_record_that_tells_too_little_is_refused(swept: Recording) -> None:
    arm = arm_with_tool(CELL)

    def with_data(data: np.ndarray) -> Recording:
        return Recording(swept.names, swept.units, swept.rate, data)

    with pytest.raises(SweepError, match="samples are of steady motion, must be >= 2500"):
        friction_and_gravity(with_data(swept.data[:1_000]), arm, CELL.friction)
    still = swept.data.copy()
    still[:, 3] = 0.2
    with pytest.raises(SweepError, match="joint 4 turns both ways at 0 rad/s only, must be > 0.02 rad/s"):
        friction_and_gravity(with_data(still), arm, CELL.friction)


def test_motions_are_within_limits_and_said_before_any_is_made() -> None:
    cell = CellConfig()
    steps = sweep_steps(cell)
    assert len(steps) == 2 * cell.friction.poses + 1
    assert all(step.words.startswith(("move to (", "to and fro by ")) for step in steps)
    with pytest.raises(ValueError, match=r"joint 2 is at 130 deg, must be -90 to 110"):
        sweep_steps(load(None, CellConfig, ["friction.highest=[40,130,10,80,80,80]"]))
    with pytest.raises(ValueError, match="keep the tool within the box limits.lowest"):
        sweep_steps(load(None, CellConfig, ["limits.lowest=[0.6,-0.01,0.6]", "limits.highest=[0.7,0.01,0.8]"]))


def test_a_fault_and_a_stop_keep_what_was_recorded(tmp_path: Path) -> None:
    said = [""]
    with (
        raw_run(tmp_path / "one", CELL) as folder,
        pytest.raises(Stopped, match="sweep: stopped by its user; what is recorded is in"),
    ):
        sweep(CELL, False, folder, said.append, Conduct(lambda: "to and fro" in said[-1]))
    assert said[-1].endswith("in motion 2 of 15: the arm holds")
    assert records_of(tmp_path / "one")["sweep"].data.any()
    heavy = load(None, CellConfig, [*QUICK, "simulator.options.payload=60"])
    with (
        raw_run(tmp_path / "two", heavy) as folder,
        pytest.raises(PartEnded, match="sweep: the robot is at fault; in motion"),
    ):
        sweep(heavy, False, folder, lambda _: None, Conduct())
    with raw_run(tmp_path / "two", heavy) as folder:
        assert not is_swept(folder)
