"""A part of an experiment: one graph, what is recorded of it, and what happens in which order."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from ctlblocks import Block, Graph, Port
from ctlblocks.clock import Clock
from ctlblocks.recording import Recording
from ctlblocks.replay import Record, numbered
from ctlblocks.taps import Tap, attach


def nothing() -> None:
    """Do nothing."""


def unheld(on: bool) -> None:
    """Hold nothing."""


@dataclass(frozen=True)
class Track:
    """What is recorded together, at one rate.

    Parameters
    ----------
    name : str
        Of its file, without a suffix.
    taps : tuple of Tap
    made : frozenset of str
        Names of the taps that controllers make: these a replay makes again.
    every : int, ticks, >= 1
        From one sample to the next.
    channels : callable(Port) -> tuple of str
        How the channels of a tap are called.
    """

    name: str
    taps: tuple[Tap, ...]
    made: frozenset[str]
    every: int = 1
    channels: Callable[[Port], tuple[str, ...]] = numbered

    def ports(self, graph: Graph) -> tuple[Port, ...]:
        """Return the ports of a sink for it."""
        return tuple(tap.port(graph) for tap in self.taps)

    def names(self, graph: Graph) -> tuple[str, ...]:
        """Return the names of its channels."""
        return tuple(name for port in self.ports(graph) for name in self.channels(port))

    def made_names(self, graph: Graph) -> list[str]:
        """Return the names of the channels that a replay makes again."""
        return [name for port in self.ports(graph) if port.name in self.made for name in self.channels(port)]


@dataclass(frozen=True)
class Phase:
    """A stretch of a part.

    Parameters
    ----------
    name : str
    ticks : int, >= 0
    begin, end : callable()
        Called before its first tick and after its last one, and not where it was stopped; what either raises ends the
        part.
    every : int, >= 0
        Ticks from one call of `look` to the next; 0 where that is not called.
    look : callable() -> bool
        Whether it is over, with ticks left.
    """

    name: str
    ticks: int
    begin: Callable[[], object] = nothing
    end: Callable[[], object] = nothing
    every: int = 0
    look: Callable[[], bool] = lambda: False


@dataclass(frozen=True)
class Retreat:
    """How the devices of a part come to rest where it ends before its end.

    Parameters
    ----------
    fault : callable() -> str
        What has latched, or nothing; asked between ticks.
    begin : callable(str)
        Brings them to rest for a reason; does nothing where a fault has done so.
    ticks : int
        That are run and recorded of it, at most.
    every, look
        As of `Phase`: whether they are at rest.
    """

    fault: Callable[[], str]
    begin: Callable[[str], object]
    ticks: int
    every: int = 0
    look: Callable[[], bool] = lambda: False


@dataclass(frozen=True)
class Part:
    """One graph of an experiment, with its devices open.

    Parameters
    ----------
    name : str
        Within its experiment; empty where that has one part.
    graph : Graph
        Not prepared.
    tracks : sequence of Track
    phases : sequence of Phase
    clock : Clock or None
        The devices' own; None where nothing outside keeps time.
    retreat : Retreat or None
        None where nothing has to come to rest.
    counts : callable() -> dict
        What its blocks have counted, for the event of its end.
    is_apart : bool
        Whether the next part is run though a fault has ended this one.
    rest : callable()
        Called once the graph ticks no more, whatever has ended it: what is led is held from then on.
    about : mapping of str to str
        What is to be known of it beside its recordings: provenance of theirs.
    progress : callable() -> float, optional
        How far it is, in the unit in which its experiment tells its length; that is s without.
    hold : callable(bool)
        Told, as often as it is asked whether to stop, whether what is led is to be held.
    late : callable() -> int
        Ticks by which its phases have become longer so far, since what is led was held.
    """

    name: str
    graph: Graph
    tracks: Sequence[Track]
    phases: Sequence[Phase]
    clock: Clock | None = None
    retreat: Retreat | None = None
    counts: Callable[[], dict[str, Any]] = dict
    is_apart: bool = False
    rest: Callable[[], object] = nothing
    about: Mapping[str, str] = field(default_factory=dict)
    progress: Callable[[], float] | None = None
    hold: Callable[[bool], object] = unheld
    late: Callable[[], int] = int

    @property
    def ticks(self) -> int:
        """Of all its phases."""
        return sum(phase.ticks for phase in self.phases)

    @property
    def seconds(self) -> float:
        """Of what its graph has ticked so far."""
        return self.graph.ticks * self.graph.frames / self.graph.rate

    @property
    def done(self) -> float:
        """How far it is, in the unit in which its experiment tells its length."""
        return self.seconds if self.progress is None else self.progress()

    def fault(self) -> str:
        """Return what has latched, or nothing."""
        return "" if self.retreat is None else self.retreat.fault()

    def attach(self, sink_of: Callable[[Track], Block], name: str = "recorder") -> None:
        """Add a sink for each track to the graph, under a name and a number."""
        for number, track in enumerate(self.tracks):
            attach(self.graph, f"{name}_{number}", sink_of(track), track.taps, track.every)

    def in_memory(self, name: str = "recorder") -> Callable[[], dict[str, Recording]]:
        """Add sinks that keep all in memory, as `attach` does; return what gives their recordings, by track."""
        kept: dict[str, tuple[Track, Record]] = {}

        def sink(track: Track) -> Block:
            kept[track.name] = track, Record(track.ports(self.graph), max(1, -(-self.ticks // track.every)))
            return kept[track.name][1]

        def recordings() -> dict[str, Recording]:
            return {
                name: replace(record.recording(dict(self.about)), names=track.names(self.graph))
                for name, (track, record) in kept.items()
                if record.position
            }

        self.attach(sink, name)
        return recordings
