"""Replay: the recorded sensors go through the run's own graph again, and every output must come out as it was."""

from collections.abc import Iterator
from pathlib import Path

from rigkit.experiment.replayed import Replayed, compared
from stagectl.cell import MADE, Cell, kept_in, memory, recorded
from stagectl.session import RECORDING, UNCOMPENSATED, read_recording
from stagectl.setup import Setup


def replay(path: Path, made: Setup) -> Iterator[Replayed]:
    """Make the outputs of a run again from its recorded sensors and wanted positions.

    Parameters
    ----------
    path : Path
        Run folder.
    made : Setup
        `session.setup_of(path)` for what was done; of other settings or models for what would have been done to the
        sensors as they were.

    Raises
    ------
    ValueError : nothing is recorded.
    """
    if made.config.session.live:
        raise ValueError(f"{path}: a live run's controllers ran in the stage, there is nothing to replay here")
    found = [(name, read_recording(path, name)) for name in (UNCOMPENSATED, RECORDING)]
    if all(record is None for _, record in found):
        raise ValueError(f"{path}: nothing is recorded")
    config = made.config
    for name, record in found:
        if record is None:
            continue
        wanted = record.select([f"wanted_{axis}" for axis in config.stage.axes])
        kept = memory(made, len(record.data))
        compensate = config.deflection.on and name == RECORDING
        cell = Cell(made, wanted, recorded(record, config), compensate, {"record": kept})
        rows = len(record.data)
        cell.run(lambda _: None, lambda cell=cell, rows=rows: _ends_here(cell, made, rows))  # type: ignore[misc]
        again = kept_in(kept, made, {})
        for output in MADE:
            for axis in config.stage.axes:
                channel = f"{output}_{axis}"
                yield from compared(name, record, again.select([channel]))


def _ends_here(cell: Cell, made: Setup, rows: int) -> bool:
    """Whether the recorded run was stopped at this sample: only the way to rest is left."""
    return rows < made.timeline.total and cell.graph.ticks >= rows - round(
        1.1 * made.config.limits.ramp * made.config.stage.rate
    )
