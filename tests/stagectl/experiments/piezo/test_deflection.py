"""What the laser sees of the robot is taken off the reference, and what it sees of the plate is not."""

import numpy as np

from stagectl.config import Deflection
from stagectl.experiments.piezo.deflection import DeflectionReference

RATE = 10_000.0


def reference(deflection: Deflection, robot: np.ndarray, plate: np.ndarray, late: int) -> np.ndarray:
    """Return the reference for a wanted position of zero; the laser sees the plate `late` samples late."""
    block = DeflectionReference(deflection, 1)
    block.prepare(RATE, len(robot))
    seen = robot + np.concatenate([np.zeros(late), plate[: len(plate) - late]])
    made = np.empty((len(robot), 1))
    block.process(np.zeros((len(robot), 1)), seen[:, None], plate[:, None], made)
    return made[:, 0]


def test_a_robot_that_gives_way_moves_the_reference_the_other_way() -> None:
    robot = np.full(200, 30e-6)
    np.testing.assert_allclose(reference(Deflection(corner=2_000.0), robot, np.zeros(200), 0)[-1], -30e-6, rtol=1e-9)


def test_the_low_pass_takes_its_time() -> None:
    made = reference(Deflection(corner=100.0), np.full(200, 1.0), np.zeros(200), 0)
    time = (np.arange(200) + 1) / RATE
    np.testing.assert_allclose(made, -(1 - np.exp(-2 * np.pi * 100.0 * time)), rtol=1e-9)


def test_a_plate_that_moves_does_not_move_its_own_reference_when_the_delay_is_right() -> None:
    plate = np.sin(np.arange(500) / 10.0)
    right, wrong = (reference(Deflection(delay=delay), np.zeros(500), plate, 3) for delay in (3, 1))
    assert np.abs(right).max() == 0.0
    assert np.abs(wrong).max() > 0.05
