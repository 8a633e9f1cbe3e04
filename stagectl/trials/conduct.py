"""How trials and pockets are conducted, and what comes of one."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ctlblocks import Graph
from ctlblocks.clock import Offline
from ctlblocks.recording import Recording
from rigkit.experiment.part import nothing
from rigkit.experiment.runner import never
from stagectl.link.tell import Tell, nobody

AFTERWARDS = 0.5
"""s that are recorded of a hold, beside `limits.stop`."""

Advance = Callable[[Graph, int], object]
"""Ticks a graph so many times: `Offline().advance`, or `Paced().advance`."""


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
        As fast as it goes unless given.
    rest : callable()
        Called once the graph ticks no more: a live robot is held from then on.
    """

    tell: Tell = nobody
    stopped: Callable[[], bool] = never
    show: Callable[[int], object] = quietly
    advance: Advance = Offline().advance
    rest: Callable[[], object] = nothing
