"""How trials and pockets are conducted, and what comes of one."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ctlblocks import Graph
from ctlblocks.clock import Timer, run_offline
from ctlblocks.recording import Recording
from stagectl.link.tell import Tell, nobody

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
