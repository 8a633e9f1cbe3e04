"""The kinds of rig that `stagectl daemon` serves: a stage, or a robot cell, as the tables of the rig file say."""

from collections.abc import Sequence
from pathlib import Path

from rigkit.config import ConfigError
from rigkit.config_source import file_values
from rigkit.service.daemon_command import Kind
from stagectl.config import StageConfig
from stagectl.robot.config import CellConfig

STAGE = Kind(StageConfig, "stagectl.daemon.stage.rig:PiezoStage")
CELL = Kind(CellConfig, "stagectl.daemon.cell.rig:RobotCell")


def kind_of(config: Path | None, settings: Sequence[str] = ()) -> Kind:
    """Return the kind of rig that a rig file is of; a stage where nothing in it tells.

    Parameters
    ----------
    config : Path or None
    settings : sequence of str
        Laid over it, "table.key=value".

    Raises
    ------
    ConfigError : it has tables that only a stage has, and such as only a cell has.
    """
    tables = set() if config is None else set(file_values(config))
    tables |= {text.partition("=")[0].partition(".")[0].strip() for text in settings}
    stage, cell = (set(kind.model.model_fields) for kind in (STAGE, CELL))
    of_stage, of_cell = sorted(tables & (stage - cell)), sorted(tables & (cell - stage))
    if of_stage and of_cell:
        raise ConfigError(
            f"{config or '--set'}: [{of_stage[0]}] is a stage's and [{of_cell[0]}] is a robot cell's, must be of one "
            "rig: each has a daemon of its own"
        )
    return CELL if of_cell else STAGE
