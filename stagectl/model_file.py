"""An innovation-form model as an HDF5 file that says where it came from."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from calibration.state_space.model import InnovationModel
from calibration.state_space.model_checks import MATRICES
from rigkit.model_file import ModelFile, ModelFileError, read_model_file, write_model_file

FORMAT = "vibrostage innovation model 1"
_WORDS = ("input_names", "output_names", "input_units", "output_units")


def write_model(path: Path, model: InnovationModel) -> None:
    """Write `model` to `path`, whole or not at all."""
    arrays = {name: getattr(model, name) for name in MATRICES} | {"rate": np.array(model.rate)}
    words = {name: getattr(model, name) for name in _WORDS}
    write_model_file(path, ModelFile(FORMAT, arrays, {"rate": "samples/s"}, words, model.provenance))


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
