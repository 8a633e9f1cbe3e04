"""What of a run has changed since it was made, whatever kind of run of stage or cell it is."""

from pathlib import Path

from rigkit import config as rig_file
from rigkit import run_origin
from rigkit.origin import RUN, read_origin
from rigkit.run_folder import CONFIG
from stagectl.config import StageConfig
from stagectl.experiments.kinds import KINDS
from stagectl.experiments.piezo.experiment import STAGE_RUN
from stagectl.link.config import GONE
from stagectl.robot.config import CellConfig


def say_changed(path: Path) -> None:
    """Say it, on the standard error; where that cannot be told, the reader of the run will say so.

    Raises
    ------
    ValueError : a run of another program.
    """
    run_origin.refuse_other_kind(path, KINDS)
    origin = read_origin(path / RUN)
    if origin is not None and (path / CONFIG).is_file():
        model = StageConfig if origin.kind == STAGE_RUN.name else CellConfig
        run_origin.say_changed(path, rig_file.load(path / CONFIG, model, as_written=True, gone=GONE))
