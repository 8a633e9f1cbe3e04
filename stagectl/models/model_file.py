"""An innovation-form model as an HDF5 file that says where it came from."""

from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from calibration.state_space.model import InnovationModel
from calibration.state_space.model_checks import MATRICES
from rigkit.model_file import ModelFile, ModelFileError, read_model_file, write_model_file
from stagectl.stage.measured_response import MeasuredResponse

FORMAT = "vibrostage innovation model 1"
_MEASURED = "measured."
_UNITS = {"frequency": "Hz", "position": "m/m", "seen": "m/m"}
_WORDS = ("input_names", "output_names", "input_units", "output_units")


def write_model(path: Path, model: InnovationModel, measured: MeasuredResponse | None = None) -> None:
    """Write `model` to `path`, with what was heard of the same plant: whole or not at all."""
    arrays = {name: getattr(model, name) for name in MATRICES} | {"rate": np.array(model.rate)}
    units = {"rate": "samples/s"}
    if measured is not None:
        arrays |= {_MEASURED + each.name: getattr(measured, each.name) for each in fields(measured)}
        units |= {_MEASURED + name: unit for name, unit in _UNITS.items()}
    words = {name: getattr(model, name) for name in _WORDS}
    write_model_file(path, ModelFile(FORMAT, arrays, units, words, model.provenance))


def read_measured(path: Path) -> MeasuredResponse | None:
    """Read what was heard of a model's plant; None where its file does not say.

    Parameters
    ----------
    path : Path

    Raises
    ------
    ModelFileError : no model file, damaged, or no such response.
    """
    names = [_MEASURED + each.name for each in fields(MeasuredResponse)]
    arrays = read_model_file(path, FORMAT, [], optional=names).arrays
    if not arrays:
        return None
    try:
        return MeasuredResponse(*(arrays[name] for name in names))
    except (KeyError, ValueError) as fault:
        raise ModelFileError(f"{path}: {fault}") from None


def read_model(
    path: Path, rate: float | None = None, inputs: Sequence[str] = (), outputs: Sequence[str] = ()
) -> InnovationModel:
    """Read a model and check that it belongs here.

    Parameters
    ----------
    path : Path
    rate : float, optional, samples/s
        At which it must have been sampled.
    inputs, outputs : names, optional
        Those it must have, in this order.

    Raises
    ------
    ModelFileError : not a model file, damaged, of another rate, or between other signals.
    """
    content = read_model_file(path, FORMAT, [*MATRICES, "rate"], _WORDS)
    if content.arrays["rate"].shape != ():
        raise ModelFileError(f"{path}: rate has shape {content.arrays['rate'].shape}, must be one number")
    words = {name: (text,) if isinstance(text, str) else tuple(text) for name, text in content.words.items()}
    parts: dict[str, Any] = {**content.arrays, **words, "provenance": content.provenance}
    try:
        model = InnovationModel(**parts | {"rate": float(parts["rate"])})
    except (ValueError, TypeError) as fault:
        raise ModelFileError(f"{path}: {fault}") from None
    if rate is not None and not abs(model.rate - rate) <= 1e-9 * rate:
        raise ModelFileError(f"{path}: sampled at {model.rate:g} samples/s, must be {rate:g}")
    for side, found, wanted in (("inputs", model.input_names, inputs), ("outputs", model.output_names, outputs)):
        if wanted and tuple(wanted) != found:
            raise ModelFileError(f"{path}: {side} are {', '.join(found)}, must be {', '.join(wanted)}")
    return model
