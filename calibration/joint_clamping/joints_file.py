"""Joint models as an HDF5 file that says where they came from."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from calibration.joint_clamping.joint_model import Estimate, JointModel
from calibration.joint_clamping.results import JointResult
from rigkit.model_file import ModelFile, ModelFileError, read_model_file, write_model_file

FORMAT = "vibrostage joint models 1"
ESTIMATES = {
    "backlash": "rad",
    "k_plus": "N m/rad",
    "k_minus": "N m/rad",
    "cubic_plus": "N m/rad^3",
    "cubic_minus": "N m/rad^3",
    "friction": "N m",
    "friction_load": "1",
}
NUMBERS = {"presliding": "rad", "centre": "rad", "offset": "N m", "residual": "N m", "cycles": "1"}


def write_joints(path: Path, results: Sequence[JointResult], provenance: Mapping[str, str]) -> None:
    """Write each joint's best model: estimate, standard error and half the interval in errors in three columns."""
    best = [result.best for result in results]
    arrays: dict[str, np.ndarray] = {"joint": np.array([result.joint + 1 for result in results])}
    for name in ESTIMATES:
        found = [getattr(model, name) for _, model in best]
        arrays[name] = np.array([[each.value, each.error, each.reach] for each in found])
    for name in NUMBERS:
        arrays[name] = np.array([getattr(model, name) for _, model in best])
    arrays["torque_range"] = np.array([model.torque_range for _, model in best])
    arrays["has_backlash"] = np.array([int(model.has_backlash) for _, model in best])
    said: dict[str, str | Sequence[str]] = {
        "spring": [model.spring for _, model in best],
        "way": [way for way, _ in best],
    }
    units = {**ESTIMATES, **NUMBERS, "torque_range": "N m"}
    write_model_file(path, ModelFile(FORMAT, arrays, units, said, provenance))


def read_joints(path: Path) -> dict[int, JointModel]:
    """Read the models; joints count from 0.

    Raises
    ------
    ModelFileError : not a file of joint models, or a damaged one.
    """
    names = ("joint", *ESTIMATES, *NUMBERS, "torque_range", "has_backlash")
    content = read_model_file(path, FORMAT, names, ("spring", "way"))
    arrays, springs = content.arrays, list(content.words["spring"])
    if any(len(arrays[name]) != len(springs) for name in names):
        raise ModelFileError(f"{path}: its arrays have different lengths")
    found = {}
    for place, joint in enumerate(arrays["joint"]):
        parts: dict[str, Any] = {name: Estimate(*map(float, arrays[name][place])) for name in ESTIMATES}
        numbers: dict[str, Any] = {name: float(arrays[name][place]) for name in NUMBERS}
        low, high = map(float, arrays["torque_range"][place])
        found[int(joint) - 1] = JointModel(
            spring="smooth" if springs[place] == "smooth" else "piecewise linear",
            torque_range=(low, high),
            has_backlash=bool(arrays["has_backlash"][place]),
            **parts,
            **numbers,
        )
    return found
