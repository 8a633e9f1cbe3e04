"""Whether a model belongs to the rig as it is wired now."""

from collections.abc import Collection
from pathlib import Path

from rigkit.agreement import agreed, measured_otherwise
from vibractl.config import RigConfig
from vibractl.model_file import read_model
from vibractl.transfer_matrix import TransferMatrix

WAY_OUT = "measure the rig as it is now with `calibrate vibrator`, or go back to that wiring"


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
    found = measured_otherwise("vibrator", {"rig": "", **matrix.provenance}, config, str(path))
    is_simulated = all(each.key.startswith("simulator.") for each in found)
    where = "another simulated machine" if found and is_simulated else "a rig that was wired otherwise"
    notes = agreed(found, accept, f"{path} was measured on {where}", WAY_OUT)
    return matrix, notes
