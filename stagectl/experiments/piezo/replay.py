"""Replay: the recorded sensors go through the run's own graph again, and every output must come out as it was."""

from collections.abc import Callable, Iterator
from pathlib import Path

from ctlblocks.recording import Recording
from rigkit.experiment.replayed import Replayed, compared
from rigkit.run_folder import make_whole, read_events
from stagectl.experiments.piezo.cell import MADE, Cell, kept_in, memory, recorded
from stagectl.experiments.piezo.session import read_recording
from stagectl.experiments.piezo.setup import Setup
from stagectl.experiments.piezo.streamed import RECORDING, UNCOMPENSATED


def replay(path: Path, made: Setup) -> Iterator[Replayed]:
    """Make the outputs of a run again from its recorded sensors and wanted positions.

    Parameters
    ----------
    path : Path
        Run folder.
    made : Setup
        `setup_as_run(path)` for what was done; of other settings or models for what would have been done to the
        sensors as they were.

    Raises
    ------
    ValueError : nothing is recorded.
    """
    if made.config.session.live:
        raise ValueError(f"{path}: a live run's controllers ran in the stage, there is nothing to replay here")
    make_whole(path)
    found = [(name, read_recording(path, name)) for name in (UNCOMPENSATED, RECORDING)]
    if all(record is None for _, record in found):
        raise ValueError(f"{path}: nothing is recorded")
    for name, record in found:
        if record is None:
            continue
        compensate = made.config.deflection.on and name == RECORDING
        again = _again(made, record, compensate, _was_killed(path, name))
        for channel in _made_names(made):
            yield from compared(name, record, again.select([channel]))


def remade(path: Path, made: Setup, read: Callable[[Recording, list[str]], Recording]) -> tuple[Recording, Recording]:
    """Make what a run's controllers would have made of somebody's log; return the log, and that.

    Parameters
    ----------
    path : Path
        Run folder: its channels.
    made : Setup
    read : callable(Recording, list of str) -> Recording
        As of `rigkit.experiment.again.remade`.

    Raises
    ------
    ValueError : nothing is recorded, or what `read` raises.
    """
    record = None if made.config.session.live else read_recording(path, RECORDING)
    if record is None:
        raise ValueError(f"{path}: has no recording of controllers in this program for a log to stand in its place")
    names = _made_names(made)
    log = read(record, names)
    return log, _again(made, log, made.config.deflection.on, False).select(names)


def _made_names(made: Setup) -> list[str]:
    return [f"{output}_{axis}" for output in MADE for axis in made.config.stage.axes]


def _was_killed(path: Path, name: str) -> bool:
    """Whether a recording ends where its program was killed: its run has begun, and nobody has told of its end."""
    told = read_events(path)
    is_told = any(event["event"] == "recorded" and event["recording"] == name for event in told)
    return any(event["event"] == "started" for event in told) and not is_told


def _again(made: Setup, record: Recording, compensate: bool, was_killed: bool) -> Recording:
    """Return all that is recorded of a run, made again from its recorded sensors and wanted positions."""
    wanted = record.select([f"wanted_{axis}" for axis in made.config.stage.axes])
    rows = len(record.data)
    kept = memory(made, rows)
    cell = Cell(made, wanted, recorded(record, made.config), compensate, {"record": kept})
    cell.run(lambda _: None, lambda: cell.graph.ticks >= rows if was_killed else _ends_here(cell, made, rows))
    return kept_in(kept, made, {})


def _ends_here(cell: Cell, made: Setup, rows: int) -> bool:
    """Whether the recorded run was stopped at this sample: only the way to rest is left."""
    return rows < made.timeline.total and cell.graph.ticks >= rows - round(
        1.1 * made.config.limits.ramp * made.config.stage.rate
    )
