"""A transfer matrix as an HDF5 file that says where it came from."""

from pathlib import Path

from rigkit.model_file import ModelFile, ModelFileError, read_model_file, write_model_file
from vibractl.transfer_matrix import TransferMatrix

FORMAT = "vibrostage transfer matrix 1"
UNITS = {"frequency": "Hz", "response": "m/s^2/V", "variance": "(m/s^2/V)^2", "coherence": "1"}


def write_model(path: Path, matrix: TransferMatrix) -> None:
    """Write `matrix` to `path`, whole or not at all."""
    arrays = {name: getattr(matrix, name) for name in UNITS}
    write_model_file(path, ModelFile(FORMAT, arrays, UNITS, provenance=matrix.provenance))


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
    content = read_model_file(path, FORMAT, list(UNITS))
    try:
        matrix = TransferMatrix(**content.arrays, provenance=content.provenance)
    except ValueError as fault:
        raise ModelFileError(f"{path}: {fault}") from None
    if rig is not None and matrix.provenance.get("rig") != rig:
        raise ModelFileError(f"{path}: measured on rig {matrix.provenance.get('rig')!r}, this rig is {rig!r}")
    if sides is not None and (matrix.outputs, matrix.inputs) != sides:
        raise ModelFileError(
            f"{path}: {matrix.outputs} accelerometers and {matrix.inputs} coils, this rig has {sides[0]} and {sides[1]}"
        )
    return matrix
