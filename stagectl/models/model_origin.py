"""Whether models of a stage's axes, or of a robot that mills, belong to the rig as its file has it now."""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

from calibration.state_space.model import InnovationModel
from rigkit.agreement import agreed, measured_otherwise
from rigkit.config import Section
from stagectl.config import StageConfig

_WAY_OUT = "calibrate it as it is now, or go back to that"


def refuse_foreign(
    config: StageConfig, files: Sequence[Path], models: Sequence[InnovationModel], accept: Collection[str]
) -> list[str]:
    """Refuse models of another axis, or of a stage that was wired otherwise; return what is to be said.

    Parameters
    ----------
    config : StageConfig
    files : sequence of Path
        One an axis, as many as `models`.
    models : sequence of InnovationModel
        One an axis; of a live stage, none as well.
    accept : collection of str
        Keys that may differ.

    Raises
    ------
    ValueError : a model is of another axis.
    DisagreementError : it says which keys of the rig file differ.
    """
    notes: list[str] = []
    axes = config.stage.axes
    for axis, file, model in zip(axes, files, models, strict=bool(models)):
        for other in axes:
            if other != axis and model.output_names == (f"position_{other}",):
                raise ValueError(
                    f"{file} is of axis {other}, must be of {axis}: models come in the order of stage.axes"
                )
        notes += refuse_other_wiring(config, file, model.provenance, accept, "stage")
    return list(dict.fromkeys(notes))


def refuse_other_wiring(
    config: Section, file: Path, provenance: Mapping[str, str], accept: Collection[str], what: str
) -> list[str]:
    """Refuse a model of a rig that was wired otherwise; return what is to be said.

    Parameters
    ----------
    config : Section
        Of the rig now.
    file : Path
    provenance : mapping of str to str
        The model's.
    accept : collection of str
        Keys that may differ.
    what : str
        Such as "stage".

    Raises
    ------
    OriginError : its configuration cannot be read.
    DisagreementError : it says which keys of the rig file differ.
    """
    found = measured_otherwise(what, provenance, config, str(file))
    return agreed(found, accept, f"{file} was measured on a {what} that was wired otherwise", _WAY_OUT)
