"""A transfer matrix as an HDF5 file that says where it came from."""

from pathlib import Path

import numpy as np

from rigkit.model_file import ModelFile, ModelFileError, read_model_file, write_model_file
from vibractl import far_field
from vibractl.far_field import FarField, delayed
from vibractl.transfer_matrix import TransferMatrix

FORMAT = "vibrostage transfer matrix 1"
UNITS = {"frequency": "Hz", "response": "m/s^2/V", "variance": "(m/s^2/V)^2", "coherence": "1"}
_FAR = {f"far_field_{name}": unit for name, unit in far_field.UNITS.items()}
"""Arrays that a model has where there were hydrophones; on the same frequencies, with the delay in the phase."""


def write_model(path: Path, matrix: TransferMatrix, far: FarField | None = None) -> None:
    """Write `matrix`, and what is known of the far field, to `path`, whole or not at all."""
    arrays = {name: getattr(matrix, name) for name in UNITS}
    if far is not None:
        values = (far.response, far.prompt.variance, far.prompt.coherence, far.delay)
        arrays |= dict(zip(_FAR, values, strict=True))
    write_model_file(path, ModelFile(FORMAT, arrays, UNITS | _FAR, provenance=matrix.provenance))


def read_model(path: Path, sides: tuple[int, int] | None = None) -> TransferMatrix:
    """Read a model; `model_origin.model_for` checks that it belongs to a rig.

    Parameters
    ----------
    path : Path
    sides : (outputs, inputs), optional
        The number of accelerometers and coils it must have.

    Raises
    ------
    ModelFileError : not a model file, damaged, or of another size.
    """
    content = read_model_file(path, FORMAT, list(UNITS))
    try:
        matrix = TransferMatrix(**content.arrays, provenance=content.provenance)
    except ValueError as fault:
        raise ModelFileError(f"{path}: {fault}") from None
    if sides is not None and (matrix.outputs, matrix.inputs) != sides:
        raise ModelFileError(
            f"{path}: {matrix.outputs} accelerometers and {matrix.inputs} coils, this rig has {sides[0]} and {sides[1]}"
        )
    return matrix


def read_far_field(path: Path, hydrophones: int | None = None) -> FarField | None:
    """Read what a model knows of the far field; None where it was measured without hydrophones.

    Parameters
    ----------
    path : Path
    hydrophones : int, optional
        How many this rig has; with 0 the far field is not read.

    Raises
    ------
    ModelFileError : not a model file, damaged, or of another number of hydrophones.
    """
    if hydrophones == 0:
        return None
    content = read_model_file(path, FORMAT, list(UNITS), optional=list(_FAR))
    there = [name for name in _FAR if name in content.arrays]
    if not there:
        return None
    try:
        if len(there) < len(_FAR):
            raise ValueError(f"of the far field there is {', '.join(there)}, must be {', '.join(_FAR)}")
        parts = [np.asarray(content.arrays[name]) for name in _FAR]
        if parts[0].shape[2:] != content.arrays["response"].shape[1:2]:
            raise ValueError(f"far_field_response has shape {parts[0].shape}, must end in the accelerometers")
        found = delayed(content.arrays["frequency"], *parts)
    except ValueError as fault:
        raise ModelFileError(f"{path}: {fault}") from None
    if hydrophones is not None and found.hydrophones != hydrophones:
        raise ModelFileError(f"{path}: measured with {found.hydrophones} hydrophones, this rig has {hydrophones}")
    return found
