"""A transfer matrix as an HDF5 file that says where it came from."""

import os
from pathlib import Path

import h5py
import numpy as np

from vibractl.transfer_matrix import TransferMatrix

FORMAT = "vibrostage transfer matrix 1"
UNITS = {"frequency": "Hz", "response": "m/s^2/V", "variance": "(m/s^2/V)^2", "coherence": "1"}


class ModelFileError(ValueError):
    """A file that is not a usable model of this rig."""


def write_model(path: Path, matrix: TransferMatrix) -> None:
    """Write `matrix` to `path`, whole or not at all."""
    partial = path.with_name(f".{path.name}.partial")
    with h5py.File(partial, "w") as file:
        file.attrs["format"] = FORMAT
        for name, unit in UNITS.items():
            file.create_dataset(name, data=getattr(matrix, name)).attrs["unit"] = unit
        for name, text in matrix.provenance.items():
            file.attrs[f"provenance.{name}"] = text
    os.replace(partial, path)


def read_model(path: Path, rig: str | None = None, sides: tuple[int, int] | None = None) -> TransferMatrix:
    """Read a model and check that it belongs here.

    Parameters
    ----------
    path : Path
    rig : str, optional
        Name of the rig it must have been measured on.
    sides : (outputs, inputs), optional
        The number of accelerometers and coils it must have.

    Raises
    ------
    ModelFileError : not a model file, damaged, of another rig, or of another size.
    """
    if not path.is_file():
        raise ModelFileError(f"{path}: no such model file")
    try:
        with h5py.File(path, "r") as file:
            if file.attrs.get("format") != FORMAT:
                raise ModelFileError(f"{path}: format is {file.attrs.get('format')!r}, must be {FORMAT!r}")
            prefix = "provenance."
            provenance = {key[len(prefix) :]: str(text) for key, text in file.attrs.items() if key.startswith(prefix)}
            parts = {name: np.asarray(file[name]) for name in UNITS}
            matrix = TransferMatrix(**parts, provenance=provenance)
    except (OSError, KeyError) as fault:
        raise ModelFileError(f"{path}: not a readable model file ({fault})") from None
    except ModelFileError:
        raise
    except ValueError as fault:
        raise ModelFileError(f"{path}: {fault}") from None
    if rig is not None and provenance.get("rig") != rig:
        raise ModelFileError(f"{path}: measured on rig {provenance.get('rig')!r}, this rig is {rig!r}")
    if sides is not None and (matrix.outputs, matrix.inputs) != sides:
        raise ModelFileError(
            f"{path}: {matrix.outputs} accelerometers and {matrix.inputs} coils, this rig has {sides[0]} and {sides[1]}"
        )
    return matrix
