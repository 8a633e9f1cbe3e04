"""Gears that couple joints: motor quantities come to the joints with the same power, and a bad coupling is refused."""

import numpy as np
import pytest
from pydantic import ValidationError

from stagectl.robot.config import Robot
from stagectl.robot.gears import joint_side
from stagectl.robot.program import TorqueSignals

WRIST = np.eye(6)
WRIST[4, 3], WRIST[5, 3], WRIST[5, 4] = -0.02, 0.03, 0.01


def rows(gear: np.ndarray) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(row) for row in gear.tolist())


def test_motor_quantities_come_to_the_joint_with_the_same_power() -> None:
    gear = np.array([[100.0, 0.0], [20.0, -50.0]])
    speed, torque = np.array([[0.1, 0.2]]), np.array([[3.0, 4.0]])
    motor_speed, motor_torque = speed @ gear.T, torque @ np.linalg.inv(gear)
    got = joint_side(motor_speed, motor_torque, gear)
    np.testing.assert_allclose(got[0], speed)
    np.testing.assert_allclose(got[1], torque)


def test_the_torque_line_of_a_coupled_wrist_gives_what_the_joints_do() -> None:
    joints, torques = np.radians([10.0, 20.0, -30.0, 40.0, 50.0, -60.0]), np.array([90.0, -70.0, 40.0, 5.0, 4.0, 2.0])
    signals = TorqueSignals(Robot(coupling=rows(WRIST)), "127.0.0.1", lambda: 0.0)
    motors = [1.5, *np.degrees(WRIST @ joints), *(torques @ np.linalg.inv(WRIST))]
    signals.take((",".join(f"{each:.15g}" for each in motors) + "\n").encode(), 2.0)
    np.testing.assert_allclose(signals.newest, [1.5, *joints, *torques], rtol=1e-12)


@pytest.mark.parametrize(
    ("coupling", "says"),
    [
        (WRIST[:5], "robot.coupling has 5 rows, must have 6, or none"),
        (np.diag([1.0, 1.0, 1.0, 1.0, 1.0, 0.01]), "smallest singular value 0.01, must be >= 0.05 and finite"),
    ],
)
def test_a_coupling_that_cannot_be_undone_is_refused(coupling: np.ndarray, says: str) -> None:
    with pytest.raises(ValidationError, match=says):
        Robot(coupling=rows(coupling))
