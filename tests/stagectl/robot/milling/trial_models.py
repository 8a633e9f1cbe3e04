"""A milling robot as linear models: exact ones to test the learning on."""

import numpy as np

from calibration.state_space.model import InnovationModel
from stagectl.robot.milling.axis_model import AxisModel
from stagectl.robot.milling.learning import ProcessModel

RATE = 250.0


def axis(delay: int = 2, zero: float = -1.6) -> AxisModel:
    """Return a mode of 12 Hz behind a low-pass and a delay; with a zero outside the unit circle by default."""
    pole = 0.93 * np.exp(2j * np.pi * 12.0 / RATE)
    a = np.real(np.poly([0.7, pole, pole.conjugate()]))
    b = np.array([1.0, -zero - 0.2, 0.2 * zero])
    return AxisModel(b * a.sum() / b.sum(), a, delay, RATE)


def process(stiffness: float = 3e5) -> ProcessModel:
    """Return force from speed (2 N a mm/s along x and y, some across), and springs with a lag of 30 ms."""
    lag = 0.9
    slope = 2e3 * RATE * (1 - lag)
    force = InnovationModel(
        lag * np.eye(3), np.eye(3), -slope * (1 - lag) * _cross(), slope * _cross(), np.zeros((3, 3)), RATE, np.eye(3)
    )
    springs = np.diag([1.0, 1.6, 0.6]) + 0.15
    compliance = InnovationModel(
        lag * np.eye(3), (1 - lag) * np.eye(3), springs / stiffness, np.zeros((3, 3)), np.zeros((3, 3)), RATE, np.eye(3)
    )
    return ProcessModel(force, compliance)


def _cross() -> np.ndarray:
    return -np.array([[1.0, 0.3, 0.0], [-0.3, 1.0, 0.0], [0.1, 0.1, 0.2]])


def square(rest: float = 1.5, side: float = 8e-3, seconds: float = 1.2) -> np.ndarray:
    """Return a square in x and y with smooth sides, that rests at its ends: shape (N, 3), m."""
    ease = 0.5 - 0.5 * np.cos(np.pi * np.arange(round(seconds * RATE)) / round(seconds * RATE))
    corners = side * np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 0]])
    sides = [a + ease[:, None] * (b - a) for a, b in zip(corners, corners[1:], strict=False)]
    still = np.tile(corners[:1], (round(rest * RATE), 1)).astype(float)
    return np.concatenate([still, *sides, still])
