"""A run's controllers fed again: with what its sensors said, or with another program's log."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from ctlblocks.recording import Recording
from rigkit.experiment.kept import records_of, told
from rigkit.experiment.kind import Kind
from rigkit.experiment.replayed import Replayed, compared
from rigkit.experiment.runner import repeated
from rigkit.run_folder import make_whole


def replayed(path: Path, kind: Kind, settings: Sequence[str] = ()) -> Iterator[Replayed]:
    """Make every output of a run's controllers again from its recorded sensors.

    Parameters
    ----------
    path : Path
        Of its folder.
    kind : Kind
    settings : sequence of str
        Laid over its rig file: what would have been made of the sensors as they were.

    Raises
    ------
    ValueError : nothing is recorded, or it cannot be made again.
    """
    make_whole(path)
    records = records_of(path)
    parts = kind.read(path, records, settings).again(records)
    if not records:
        raise ValueError(f"{path}: nothing is recorded")
    ends, holds = told(path, "ended"), told(path, "held")
    for part in parts:
        end, whole = ends.get(part.name), {track.name: len(records[track.name].data) for track in part.tracks}
        ticks = end["ticks"] if end else min(whole[track.name] * track.every for track in part.tracks)
        held = holds.get(part.name) or end  # folders of before have it at the end alone
        again = repeated(part, ticks, held["held_at"] if held else None)
        for track in part.tracks:
            if not track.made:
                continue
            record = records[track.name]
            names = [name for name in track.made_names(part.graph) if name in record.names]  # once there were fewer
            made = again[track.name].select(names)
            rows = whole[track.name] if end else len(made.data)  # of one that was killed, as far as all is recorded
            yield from compared(track.name, replace(record, data=record.data[:rows]), made)


def remade(
    path: Path, kind: Kind, settings: Sequence[str], read: Callable[[Recording, list[str]], Recording]
) -> tuple[Recording, Recording]:
    """Make what a run's controllers would have made of somebody's log; return the log, and that.

    Parameters
    ----------
    path : Path
        Of a run's folder: what is run, its settings and its channels.
    kind : Kind
    settings : sequence of str
        Laid over its rig file.
    read : callable(Recording, list of str) -> Recording
        Reads the log with the channels of the run's recording, of which those that controllers make may be missing.

    Raises
    ------
    ValueError : the run has recordings of several rates, or what `read` raises.
    """
    make_whole(path)
    records = records_of(path)
    if kind.stands_in in records:
        records = {kind.stands_in: records[kind.stands_in]}
    if len(records) != 1:
        have = ", ".join(f"{name} at {each.rate:g} samples/s" for name, each in records.items()) or "nothing"
        raise ValueError(f"{path}: has recorded {have}, must be one recording for a log to stand in its place")
    ((name, record),) = records.items()
    (before,) = kind.read(path, records, ()).again(records)
    log = read(record, before.tracks[0].made_names(before.graph))
    (part,) = kind.read(path, {name: log}, settings).again({name: log})
    track = part.tracks[0]
    return log, repeated(part, len(log.data) * track.every)[name].select(track.made_names(part.graph))
