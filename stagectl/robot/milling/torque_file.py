"""Gravity and friction ranges in the file of milling models, and the force model that they make."""

from pathlib import Path
from typing import Any

import numpy as np

from rigkit.model_file import ModelFileError, read_model_file
from stagectl.robot.arm import Arm
from stagectl.robot.milling.force_model import ForceModel
from stagectl.robot.milling.friction_range import FrictionRange
from stagectl.robot.milling.gravity import Gravity

FORMAT = "vibrostage milling models 1"
UNITS = {
    "gravity/moments": "kg m, kg m, kg m, kg",
    "friction/speed": "rad/s",
    "friction/low": "N m",
    "friction/high": "N m",
    "friction/covariance": "(N m)^2",
    "friction/smoothing": "s",
}
"""Its arrays about torques, and their units."""


def torque_arrays(friction: FrictionRange, gravity: Gravity) -> dict[str, np.ndarray]:
    """Return both as arrays for the file, by the names of `UNITS`."""
    parts = {
        name: np.asarray(getattr(friction, name.removeprefix("friction/"))) for name in UNITS if "friction" in name
    }
    return {"gravity/moments": gravity.moments, **parts}


def read_force_model(path: Path, arm: Arm, tie_break: str = "centre") -> ForceModel:
    """Read gravity and friction ranges, and make them a model of forces.

    Parameters
    ----------
    path : Path
    arm : Arm
        With its tool, as at identification.
    tie_break : str
        As of `ForceModel`.

    Raises
    ------
    ModelFileError : not such a file, damaged, or without torques.
    """
    arrays = read_model_file(path, FORMAT, list(UNITS)).arrays
    if arrays["gravity/moments"].shape != (arm.joints, 4):
        raise ModelFileError(f"{path}: gravity/moments has shape {arrays['gravity/moments'].shape}, must be (6, 4)")
    try:
        parts: dict[str, Any] = {name.removeprefix("friction/"): arrays[name] for name in UNITS if "friction" in name}
        friction = FrictionRange(**parts | {"smoothing": float(parts["smoothing"])})
    except (ValueError, TypeError) as fault:
        raise ModelFileError(f"{path}: {fault}") from None
    return ForceModel(arm, Gravity(arrays["gravity/moments"]), friction, tie_break)
