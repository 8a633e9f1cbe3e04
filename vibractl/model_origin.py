"""Whether a model, or a learned drive, belongs to the rig as it is wired now."""

from collections.abc import Collection, Mapping
from pathlib import Path

from rigkit.agreement import MEASURED_ELSEWHERE, Difference, agreed, differences
from rigkit.origin import Origin
from vibractl.config import RigConfig
from vibractl.model_file import read_model
from vibractl.transfer_matrix import TransferMatrix

WAY_OUT = "measure the rig as it is now with `calibrate vibrator`, or go back to that wiring"


def wired_otherwise(provenance: Mapping[str, str], config: RigConfig, where: str) -> list[Difference]:
    """Return what differs between the rig that something was measured on and a rig as it is wired now.

    Parameters
    ----------
    provenance : mapping of str to str
        The words of a model or an entry of the library: its configuration or, without one, the rig's name.
    config : RigConfig
    where : str
        Names it in an error.

    Raises
    ------
    OriginError : its configuration cannot be read.
    """
    origin = Origin.told("vibrator model", provenance, where)
    if origin is None:
        return differences({"rig": {"name": provenance.get("rig", "")}}, config, MEASURED_ELSEWHERE)
    return differences(origin.settings, config, MEASURED_ELSEWHERE, origin.parts)


def model_for(path: Path, config: RigConfig, accept: Collection[str] = ()) -> tuple[TransferMatrix, list[str]]:
    """Read the model of a rig as it is wired now, and what is to be said of it.

    Parameters
    ----------
    path : Path
    config : RigConfig
    accept : collection of str
        Keys that may differ.

    Raises
    ------
    ModelFileError : not a model file, damaged, or of another size.
    DisagreementError : measured on another rig, or wired or scaled otherwise.
    """
    matrix = read_model(path, (len(config.audio.response_channels), len(config.audio.drive_channels)))
    found = wired_otherwise(matrix.provenance, config, str(path))
    notes = agreed(found, accept, f"{path} was measured on a rig that was wired otherwise", WAY_OUT)
    return matrix, notes
