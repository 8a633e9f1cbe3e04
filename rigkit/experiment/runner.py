"""One part of an experiment run: ticked through its phases, stopped, held, made again."""

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

from ctlblocks import Graph
from ctlblocks.clock import Clock, Offline, run_offline
from ctlblocks.recording import Recording
from rigkit.experiment.part import Part, Phase, Retreat

STOPPED = "stopped by its user"
KILLED = "killed"


def never() -> bool:
    """Do not stop."""
    return False


def unseen(graph: Graph) -> None:
    """Look at nothing."""


def unheard(event: str, fields: Mapping[str, Any]) -> None:
    """Tell nobody."""


def at_once(name: str) -> None:
    """Go on at once."""


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
        Told, now and then, how far all parts are, in the unit of the experiment's `seconds`.
    between, after : callable(str)
        Called with the name of each part before it begins, and returns when it may, or raises `rigkit.stop.Stopped`;
        and once it has ended.
    goes_on : bool
        Whether parts that stand apart are run though a fault has ended one before.
    held : callable() -> bool
        Whether what a part leads is to be held, where it can be.
    """

    stopped: Callable[[], bool] = never
    clock: Clock = field(default_factory=Offline)
    look: Callable[[Graph], object] = unseen
    show: Callable[[float], object] = lambda _: None
    between: Callable[[str], object] = at_once
    after: Callable[[str], object] = at_once
    goes_on: bool = True
    held: Callable[[], bool] = never


@dataclass(frozen=True)
class Ended:
    """How a part ended.

    Parameters
    ----------
    reason : str
        Why, where that was before its end.
    held_at : int or None
        Tick at which its retreat began, if it did.
    """

    reason: str = ""
    held_at: int | None = None


@dataclass(frozen=True)
class Attendance:
    """Who is beside a part while it runs.

    Parameters
    ----------
    attend : callable()
        Called as often as it is asked whether to stop.
    held : callable(int)
        Told of the tick at which its retreat begins, before it does.
    """

    attend: Callable[[], object] = lambda: None
    held: Callable[[int], object] = lambda _: None


ALONE = Attendance()


def play(part: Part, conduct: Conduct, beside: Attendance = ALONE, done: float = 0.0) -> Ended:
    """Run a prepared part through its phases, or into its retreat.

    Parameters
    ----------
    part : Part
        Its graph prepared.
    conduct : Conduct
    beside : Attendance
    done : float
        How far the parts before were.

    Raises
    ------
    Whatever a phase's `begin` or `end`, a block or the clock raises.
    """
    try:
        ended = _played(part, conduct, beside, done)
    except BaseException:
        with suppress(Exception):  # what has ended it is what is told
            part.rest()
        raise
    part.rest()
    return ended


def _played(part: Part, conduct: Conduct, beside: Attendance, done: float) -> Ended:
    graph, own, retreat = part.graph, part.clock, part.retreat
    clock = own or conduct.clock

    def see() -> bool:
        beside.attend()
        if own is not None:
            conduct.look(graph)
        conduct.show(done + part.done)
        return False

    def over() -> bool:
        see()
        ends = bool(part.fault()) or conduct.stopped()
        part.hold(conduct.held() and not ends)
        return ends

    for phase in part.phases:
        if over():
            break
        phase.begin()
        if not _through(phase, phase.ticks, clock, graph, over, part.late):
            break
        phase.end()
    else:
        if not over() or not part.fault():
            return Ended()
    if retreat is None:
        return Ended(STOPPED)
    held_at = graph.ticks
    beside.held(held_at)
    retreat.begin(STOPPED)
    _through(retreat, min(retreat.ticks, part.ticks + part.late() - held_at), clock, graph, see, int)
    see()
    return Ended(retreat.fault() or STOPPED, held_at)


def _through(
    stretch: Phase | Retreat,
    ticks: int,
    clock: Clock,
    graph: Graph,
    over: Callable[[], bool],
    late: Callable[[], int],
) -> bool:
    """Run to the end of a stretch of ticks, or until it says that it is over; return False where `over` was before.

    It is as many ticks longer as `late` has grown meanwhile.
    """
    every, end = stretch.every or ticks, graph.ticks - late() + ticks
    while (left := end + late() - graph.ticks) > 0:
        some = min(every, left)
        if clock.run(graph, some, over) < some:
            return False
        if stretch.every and stretch.look():
            break
    return True


def remembered(part: Part, conduct: Conduct, done: float = 0.0) -> tuple[dict[str, Recording], Ended]:
    """Run a part and keep all in memory; return its recordings, by track, and how it ended.

    Parameters
    ----------
    part : Part
    conduct : Conduct
    done : float, s
        Of the parts before.
    """
    recordings = part.in_memory()
    part.graph.prepare()
    ended = play(part, conduct, done=done)
    return recordings(), ended


def repeated(part: Part, ticks: int, held_at: int | None = None) -> dict[str, Recording]:
    """Run a part as it was run before, in memory, and return its recordings, by track.

    Parameters
    ----------
    part : Part
        With the recorded sensors in place of its devices.
    ticks : int
        Of the run.
    held_at : int or None
        Tick at which its retreat began; of no account for a part that has none.
    """
    clock = _Until(ticks if held_at is None or part.retreat is None else held_at)

    def hold(reason: str) -> None:
        if part.retreat is not None:
            part.retreat.begin(reason)
        clock.tick = ticks

    retreat = None if part.retreat is None or held_at is None else replace(part.retreat, begin=hold)
    again = replace(part, retreat=retreat, clock=clock)
    return remembered(again, Conduct(lambda: part.graph.ticks >= clock.tick))[0]


class _Until:
    """A clock that runs to a tick without a question, and no further."""

    def __init__(self, tick: int) -> None:
        self.tick = tick

    def run(self, graph: Graph, ticks: int, over: Callable[[], bool]) -> int:  # noqa: ARG002 (a clock's arguments)
        """Tick a prepared graph `ticks` times, or until the tick is reached; return the ticks run."""
        return run_offline(graph, min(ticks, max(self.tick - graph.ticks, 0)))
