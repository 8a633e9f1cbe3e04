"""All parts of an experiment, one after another: recorded into a folder as they go, or kept in memory."""

import errno
import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, closing, contextmanager

from ctlblocks import Block
from ctlblocks.recording import Recording
from ctlblocks.room import DiskFault
from rigkit.experiment.part import Part, Track
from rigkit.experiment.runner import ALONE, KILLED, STOPPED, Attendance, Conduct, Ended, play, remembered
from rigkit.provenance import now, software
from rigkit.run_folder import RunFolder
from rigkit.stream_recorder import StreamRecorder
from rigkit.stream_writer import Stream


def perform(folder: RunFolder, parts: Iterator[Part], about: Mapping[str, str], conduct: Conduct) -> dict[str, str]:
    """Run all parts, recorded into the folder as they go; return why parts ended before their end, by name.

    Each has a line "started" and a line "ended" in the folder's events, the latter with the reason.

    Parameters
    ----------
    folder : RunFolder
    parts : iterator of Part
        Of an experiment; closed at the end, and its devices with it.
    about : mapping of str to str
        Provenance of every recording.
    conduct : Conduct

    Raises
    ------
    Stopped : while held between two parts.
    Whatever ends a part; it is told in the events, and what was recorded until then is kept.
    """
    return _one_by_one(parts, conduct, lambda part, done: recorded(folder, part, about, conduct, done))


def run_in_memory(parts: Iterator[Part], conduct: Conduct) -> tuple[dict[str, str], dict[str, Recording]]:
    """Run all parts and keep all in memory; return why parts ended before their end, by name, and the recordings.

    Parameters
    ----------
    parts : iterator of Part
    conduct : Conduct
    """
    records: dict[str, Recording] = {}

    def run(part: Part, done: float) -> str:
        kept, ended = remembered(part, conduct, done)
        records.update(kept)
        return ended.reason

    return _one_by_one(parts, conduct, run), records


def _one_by_one(parts: Iterator[Part], conduct: Conduct, run: Callable[[Part, float], str]) -> dict[str, str]:
    reasons, done = {}, 0.0
    with closing(parts):  # type: ignore[type-var]  # a generator
        for part in parts:
            conduct.between(part.name)
            if conduct.stopped():  # it has not begun, and has nothing to come to rest
                reasons[part.name] = STOPPED
                break
            reason = run(part, done)
            conduct.after(part.name)
            done += part.done
            if reason:
                reasons[part.name] = reason
            if conduct.stopped() or reason == STOPPED or (reason and not (part.is_apart and conduct.goes_on)):
                break
    return reasons


def recorded(folder: RunFolder, part: Part, about: Mapping[str, str], conduct: Conduct, done: float = 0.0) -> str:
    """Run a part, recorded; return the reason of an early end, which is in the events as well.

    Parameters
    ----------
    folder : RunFolder
    part : Part
    about : mapping of str to str
        Provenance of its recordings.
    conduct : Conduct
    done : float, s
        Of the parts before.
    """
    recorders: list[StreamRecorder] = []

    def drain() -> None:
        for each in recorders:
            each.drain_when_due()
            if each.lost:
                raise DiskFault(errno.ENOSPC, each.fault or os.strerror(errno.ENOSPC), str(folder.path))

    def held(tick: int) -> None:
        folder.event("held", {"part": part.name, "seconds": part.seconds, "held_at": tick})

    beside = Attendance(drain if part.clock is None else ALONE.attend, held)
    ended = Ended(KILLED)
    try:
        with _recorders(folder, part, {**about, **part.about, "date": now(), "software": software()}) as made:
            recorders += made
            folder.event("started", {"part": part.name, "software": software()})
            ended = play(part, conduct, beside, done)
    except Exception as fault:
        ended = Ended(str(fault))
        raise
    finally:  # all is written, or known to be lost
        if recorders:
            how = {"part": part.name, "seconds": part.seconds, "ticks": part.graph.ticks, "held_at": ended.held_at}
            lost = sum(each.lost for each in recorders)
            folder.event("ended", {**how, "reason": ended.reason, "lost": lost, **part.counts()})
    return ended.reason


@contextmanager
def _recorders(folder: RunFolder, part: Part, about: Mapping[str, str]) -> Iterator[list[StreamRecorder]]:
    """Add recorders to a part's graph, prepare it and begin to record.

    What a clock outside beats is written by a thread, whatever the disk does; what is simulated waits for the disk.
    """
    made: list[StreamRecorder] = []

    def sink(track: Track) -> Block:
        path = folder.path / f"{track.name}.wav"
        stream = Stream(path, track.ports(part.graph), track.names(part.graph), about)
        made.append(StreamRecorder(stream, folder.event, has_thread=part.clock is not None))
        return made[-1]

    part.attach(sink)
    part.graph.prepare()
    with ExitStack() as stack:
        for each in made:
            stack.enter_context(each)
        yield made
