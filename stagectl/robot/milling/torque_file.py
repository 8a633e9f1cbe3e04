"""Gravity, friction ranges and inertia in the file of milling models, and the force model that they make."""

from pathlib import Path
from typing import Any

import numpy as np

from rigkit.model_file import ModelFileError, read_model_file
from stagectl.robot.arm import Arm
from stagectl.robot.learning_config import ForceEstimation
from stagectl.robot.milling.force_model import ForceModel
from stagectl.robot.milling.friction_range import FrictionRange
from stagectl.robot.milling.gravity import Gravity

FORMAT = "vibrostage milling models 1"
INERTIA = "inertia/joints"
UNITS = {
    "gravity/moments": "kg m, kg m, kg m, kg",
    "friction/speed": "rad/s",
    "friction/low": "N m",
    "friction/high": "N m",
    "friction/covariance": "(N m)^2",
    "friction/smoothing": "s",
    INERTIA: "kg m^2",
}
"""Its arrays about torques, and their units."""


def torque_arrays(friction: FrictionRange, gravity: Gravity, inertia: np.ndarray) -> dict[str, np.ndarray]:
    """Return them as arrays for the file, by the names of `UNITS`; `inertia` (6,), kg m^2."""
    parts = {
        name: np.asarray(getattr(friction, name.removeprefix("friction/"))) for name in UNITS if "friction" in name
    }
    return {"gravity/moments": gravity.moments, **parts, INERTIA: inertia}


def read_gravity(path: Path, arm: Arm) -> Gravity:
    """Read what the links weigh.

    Parameters
    ----------
    path : Path
    arm : Arm
        With its tool, as at identification.

    Raises
    ------
    ModelFileError : not such a file, damaged, without torques, or of another arm.
    """
    moments = read_model_file(path, FORMAT, ["gravity/moments"]).arrays["gravity/moments"]
    if moments.shape != (arm.joints, 4):
        raise ModelFileError(f"{path}: gravity/moments has shape {moments.shape}, must be ({arm.joints}, 4)")
    return Gravity(moments)


def read_force_model(path: Path, arm: Arm, settings: ForceEstimation) -> ForceModel:
    """Read gravity, friction ranges and inertia, and make them a model of forces.

    Parameters
    ----------
    path : Path
    arm : Arm
        With its tool, as at identification.
    settings : ForceEstimation

    Raises
    ------
    ModelFileError : not such a file, damaged, without torques, or made when inertia was not found yet.
    """
    arrays = read_model_file(path, FORMAT, [name for name in UNITS if name != INERTIA], optional=[INERTIA]).arrays
    if INERTIA not in arrays:
        raise ModelFileError(
            f"{path}: has no {INERTIA}, which bounds of forces need: let `calibrate milling` fit it again, from the "
            "recordings beside it"
        )
    gravity = read_gravity(path, arm)
    try:
        parts: dict[str, Any] = {name.removeprefix("friction/"): arrays[name] for name in UNITS if "friction" in name}
        friction = FrictionRange(**parts | {"smoothing": float(parts["smoothing"])})
        return ForceModel(arm, gravity, friction, arrays[INERTIA], settings.tie_break, settings.margin)
    except (ValueError, TypeError) as fault:
        raise ModelFileError(f"{path}: {fault}") from None
