"""Whether the models of a stage's axes belong to the stage as its rig file has it now."""

from collections.abc import Collection, Sequence
from pathlib import Path

from rigkit.agreement import MEASURED_ELSEWHERE, agreed, differences
from rigkit.origin import Origin
from stagectl.config import StageConfig
from stagectl.models import InnovationModel

_WAY_OUT = "calibrate the stage as it is now, or go back to that"


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
        origin = Origin.told("stage model", model.provenance, str(file))
        if origin is not None:
            found = differences(origin.settings, config, MEASURED_ELSEWHERE)
            notes += agreed(found, accept, f"{file} was measured on a stage that was wired otherwise", _WAY_OUT)
    return list(dict.fromkeys(notes))
