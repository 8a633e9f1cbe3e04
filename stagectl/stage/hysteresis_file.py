"""A hysteresis model as an HDF5 file that says where it came from."""

from pathlib import Path
from typing import Any

import numpy as np

from rigkit.model_file import ModelFile, ModelFileError, read_model_file, write_model_file
from stagectl.stage.hysteresis import HysteresisModel

FORMAT = "vibrostage hysteresis model 1"
_UNITS = {"low": "V", "high": "V", "cubic": "m", "weights": "m", "rate": "samples/s", "lag": "s", "delay": "samples"}
_NUMBERS = ("low", "high", "rate", "lag", "delay")
_ARRAYS = ("cubic", "rising", "falling", "thresholds", "weights")


def write_hysteresis(path: Path, model: HysteresisModel) -> None:
    """Write `model` to `path`, whole or not at all."""
    arrays = {name: np.asarray(getattr(model, name)) for name in (*_NUMBERS, *_ARRAYS)}
    write_model_file(path, ModelFile(FORMAT, arrays, _UNITS, provenance=model.provenance))


def read_hysteresis(path: Path) -> HysteresisModel:
    """Read a model.

    Raises
    ------
    ModelFileError : not a hysteresis model, damaged, or one that has no inverse.
    """
    content = read_model_file(path, FORMAT, (*_NUMBERS, *_ARRAYS))
    parts: dict[str, Any] = {name: content.arrays[name] for name in _ARRAYS}
    try:
        numbers = {name: content.arrays[name].item() for name in _NUMBERS}
        return HysteresisModel(**parts, **numbers, provenance=content.provenance)
    except (ValueError, TypeError) as fault:
        raise ModelFileError(f"{path}: {fault}") from None
