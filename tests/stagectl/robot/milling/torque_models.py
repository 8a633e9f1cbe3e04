"""An arm with gravity and friction ranges, made up."""

import numpy as np

from stagectl.robot.arm import Arm, irb140
from stagectl.robot.milling.force_model import ForceModel
from stagectl.robot.milling.friction_range import FrictionRange
from stagectl.robot.milling.gravity import Gravity
from tests.stagectl.robot.milling.force_cases import COULOMB, NOISE

ARM = irb140().with_tool(0.1)


def wide_friction(fastest: float = 100.0, smoothing: float = 0.01) -> FrictionRange:
    """Return Coulomb friction of any size and sign at any speed up to `fastest`, rad/s."""
    speed = np.linspace(-fastest, fastest, 5)[:, None] * np.ones(6)
    return FrictionRange(speed, -COULOMB * np.ones((5, 1)), COULOMB * np.ones((5, 1)), np.diag(NOISE**2), smoothing)


def some_gravity() -> Gravity:
    return Gravity(np.random.default_rng(3).uniform(0.1, 2.0, (6, 4)))


INERTIA = np.array([6.0, 9.0, 3.0, 0.2, 0.3, 0.05])
"""kg m^2."""


def wide_model() -> ForceModel:
    return ForceModel(ARM, some_gravity(), wide_friction(), INERTIA)


def angles(samples: int, seed: int = 1, arm: Arm = ARM) -> np.ndarray:
    """Draw joint angles within the limits, shape (samples, 6), rad."""
    return np.random.default_rng(seed).uniform(arm.low, arm.high, (samples, 6))
