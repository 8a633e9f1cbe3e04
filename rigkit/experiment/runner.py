"""The parts of an experiment run one after another: ticked, recorded as they go, stopped, held between two of them."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass, field

from ctlblocks import Block, Graph
from ctlblocks.clock import Clock, Offline
from ctlblocks.recording import Recording
from rigkit.experiment.part import Part, Track
from rigkit.provenance import now, software
from rigkit.run_folder import RunFolder
from rigkit.stream_recorder import StreamRecorder
from rigkit.stream_writer import Stream

STOPPED = "stopped by its user"


def never() -> bool:
    """Do not stop."""
    return False


def unseen(graph: Graph) -> None:
    """Look at nothing."""


def unshown(seconds: float) -> None:
    """Show nothing of what is done."""


def at_once(name: str) -> None:
    """Go on with the next part at once."""


@dataclass(frozen=True)
class Conduct:
    """How an experiment is conducted, and who hears of it.

    Parameters
    ----------
    stopped : callable() -> bool
        Whether it is to end now.
    clock : Clock
        Of the parts that have none of their own.
    look : callable(Graph)
        Called before each tick of the parts that have a clock of their own.
    show : callable(float)
        Told, now and then, of the seconds done, of all parts.
    between : callable(str)
        Called with the name of each part before it begins; returns when it may, or raises `rigkit.stop.Stopped`.
    """

    stopped: Callable[[], bool] = never
    clock: Clock = field(default_factory=Offline)
    look: Callable[[Graph], object] = unseen
    show: Callable[[float], object] = unshown
    between: Callable[[str], object] = at_once


def play(part: Part, conduct: Conduct, attend: Callable[[], object] = lambda: None, done: float = 0.0) -> str:
    """Run a prepared part through its phases; return why it ended before its end, or nothing.

    Parameters
    ----------
    part : Part
        Its graph prepared.
    conduct : Conduct
    attend : callable()
        Called as often as it is asked whether to stop.
    done : float, s
        Of the parts before.

    Raises
    ------
    Whatever a phase's `begin` or `end`, a block or the clock raises.
    """
    graph, own = part.graph, part.clock

    def over() -> bool:
        attend()
        if own is not None:
            conduct.look(graph)
        conduct.show(done + graph.ticks * graph.frames / graph.rate)
        return conduct.stopped()

    for phase in part.phases:
        if over():
            return STOPPED
        phase.begin()
        if (own or conduct.clock).run(graph, phase.ticks, over) < phase.ticks:
            return STOPPED
        phase.end()
    over()
    return ""


def remembered(part: Part, conduct: Conduct, done: float = 0.0) -> tuple[dict[str, Recording], str]:
    """Run a part and keep all in memory; return its recordings, by track, and why it ended before its end.

    Parameters
    ----------
    part : Part
    conduct : Conduct
    done : float, s
        Of the parts before.
    """
    recordings = part.in_memory()
    part.graph.prepare()
    reason = play(part, conduct, done=done)
    return recordings(), reason


def perform(folder: RunFolder, parts: Iterator[Part], about: Mapping[str, str], conduct: Conduct) -> str:
    """Run all parts, recorded into the folder as they go; return why that ended before its end, or nothing.

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
    reason, done = "", 0.0
    with closing(parts):  # type: ignore[type-var]  # a generator
        for part in parts:
            conduct.between(part.name)
            reason = _recorded(folder, part, about, conduct, done)
            done += part.graph.ticks * part.graph.frames / part.graph.rate
            if reason:
                break
    return reason


def _recorded(folder: RunFolder, part: Part, about: Mapping[str, str], conduct: Conduct, done: float) -> str:
    """Run a part, recorded; return the reason of an early end, which is in the events as well."""
    reason = "killed"
    with _recorders(folder, part, {**about, "date": now(), "software": software()}) as recorders:
        folder.event("started", {"part": part.name, "software": software()})

        def drain() -> None:
            for each in recorders:
                each.drain_when_due()

        try:
            reason = play(part, conduct, drain if part.clock is None else lambda: None, done)
        except Exception as fault:
            reason = str(fault)
            raise
        finally:
            seconds = part.graph.ticks * part.graph.frames / part.graph.rate
            lost = sum(each.lost for each in recorders)
            folder.event("ended", {"part": part.name, "seconds": seconds, "reason": reason, "lost": lost})
    return reason


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
