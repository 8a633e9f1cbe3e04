"""A run of the cell: rest, touch off, the circle; whatever goes wrong ends in a hold and a named reason."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ctlblocks import Graph
from ctlblocks.clock import Timer, run_offline
from ctlblocks.recording import Recording
from stagectl.link.tell import Tell, nobody
from stagectl.machining.cell_graph import CellGraph
from stagectl.machining.plan import RATE, Plan
from stagectl.machining.recorded import Signal, named
from stagectl.machining.surroundings import Surroundings

CHUNK = 500
"""Ticks between two looks at faults, and at whether the run is to stop."""
AFTERWARDS = 0.5
"""s that are recorded of a hold, beside `limits.stop`."""

STOPPED = "stopped by its user"

Advance = Callable[[Graph, int], object]
"""Ticks a graph so many times: `offline`, or `paced`."""


def offline(graph: Graph, ticks: int) -> None:
    """Tick as fast as it goes."""
    run_offline(graph, ticks)


def paced(graph: Graph, ticks: int) -> None:
    """Tick in real time; TimeoutError where the computer falls behind by a second."""
    Timer(graph, ()).run(ticks)


def never() -> bool:
    """Do not stop."""
    return False


def nothing() -> None:
    """Do nothing: nobody is led any more."""


def quietly(done: int) -> None:
    """Show nothing of the ticks done."""


@dataclass(frozen=True)
class Milled:
    """What came of a run.

    Parameters
    ----------
    recordings : dict of str to Recording
    reason : str
        Why it was held, or nothing.
    figures : dict
        Counts that are in no recording.
    """

    recordings: dict[str, Recording]
    reason: str
    figures: dict[str, Any]


@dataclass(frozen=True)
class Conduct:
    """How a run is conducted, and who hears of it.

    Parameters
    ----------
    tell : callable(event, fields)
        Told of faults.
    stopped : callable() -> bool
    show : callable(int)
        Told of the ticks done, now and then.
    advance : callable(Graph, int)
        `offline` or `paced`.
    rest : callable()
        Called once the graph ticks no more: a live robot is held from then on.
    """

    tell: Tell = nobody
    stopped: Callable[[], bool] = never
    show: Callable[[int], object] = quietly
    advance: Advance = offline
    rest: Callable[[], object] = nothing


def mill(
    plan: Plan,
    conduct: Conduct,
    surroundings: Surroundings,
    recorded: dict[str, tuple[Signal, ...]],
    about: dict[str, str],
) -> Milled:
    """Run a setup from its first sample to its last, or into its hold.

    Parameters
    ----------
    plan : Plan
    conduct : Conduct
    surroundings : Surroundings
    recorded : dict of str to tuple of Signal
        What is recorded, by the name of the recording.
    about : dict of str to str
        Provenance of the recordings.
    """
    cell = CellGraph(plan, conduct.tell, surroundings, recorded)
    total = round(plan.path.seconds * RATE)
    starts = {round(plan.cell.toroid.lead * RATE): cell.follow}
    if plan.has_stage:
        starts[round(plan.stage.limits.ramp * RATE) + 2] = cell.stage.start
    left = round((plan.cell.limits.stop + AFTERWARDS) * RATE)
    for done in sorted({*starts, *range(CHUNK, total, CHUNK), total}):
        conduct.advance(cell.graph, done - cell.graph.ticks)
        conduct.show(done)
        cell.heed_the_stage()
        if cell.port.reason or conduct.stopped():
            cell.port.hold(STOPPED)
            conduct.advance(cell.graph, min(left, total - done))
            break
        if done in starts:
            starts[done]()
    kept = {name: named(cell.records[name], signals, about) for name, signals in recorded.items()}
    return Milled(kept, cell.port.reason, cell.figures())
