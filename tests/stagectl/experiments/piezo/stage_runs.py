"""Runs of the stage in folders, as the command makes them, and what came of them."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from ctlblocks.recording import Recording
from rigkit.experiment import again, kept
from rigkit.experiment.replayed import Replayed
from rigkit.experiment.runner import Conduct, never
from rigkit.run_folder import RunFolder
from stagectl.config import StageConfig
from stagectl.experiments.piezo.cell import RECORDING
from stagectl.experiments.piezo.experiment import STAGE_RUN, StageRun
from stagectl.experiments.piezo.fit import new_setup


def new_run(path: Path, config: StageConfig, models: Sequence[Path]) -> tuple[RunFolder, StageRun]:
    """Make the folder of a run."""
    run = StageRun(new_setup(config, models), models)
    return kept.create(path, STAGE_RUN, config, run, run.take_into), run


def carried_out(
    path: Path, config: StageConfig, models: Sequence[Path], stopped: Callable[[], bool] = never
) -> tuple[dict[str, str], dict[str, Any]]:
    """Make a run and carry it out; return why parts ended early, and its figures."""
    folder, run = new_run(path, config, models)
    with folder:
        return kept.run(folder, STAGE_RUN, run, Conduct(stopped))


def recording_of(path: Path, name: str = RECORDING) -> Recording:
    """Return a recording of a run."""
    return kept.records_of(path)[name]


def replay(path: Path) -> list[Replayed]:
    """Return every output of a run, made again."""
    return list(again.replayed(path, STAGE_RUN))
