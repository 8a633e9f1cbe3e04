"""A pocket milled segment by segment; whatever goes wrong ends in a retreat or a hold, and a named reason."""

from collections.abc import Callable
from dataclasses import dataclass

from ctlblocks.recording import Recording
from rigkit.experiment.runner import STOPPED
from stagectl.devices.signals import Signal, named
from stagectl.feed.constant_feed import ConstantFeed
from stagectl.feed.feed_graph import FeedGraph
from stagectl.feed.plan import RATE, FeedPlan
from stagectl.feed.recorded import SLOW
from stagectl.feed.surroundings import Surroundings
from stagectl.planning.milling import Milled, Planner
from stagectl.robot.milling.feed_force import FeedForce
from stagectl.trials.conduct import AFTERWARDS, Conduct

LEAD = 0.2
"""s at rest, beside those in which zero force is taken, before the robot follows, and at the end."""
CHUNK = 5 * SLOW
"""Ticks between two looks at faults, at the planner, and at whether the run is to stop: 20 ms."""
LONGEST = 600.0
"""s of a pocket, for which there is room in its recording."""


@dataclass(frozen=True)
class Pocketed:
    """What came of a pocket.

    Parameters
    ----------
    recording : Recording
    segments : tuple of Milled
        Those that were finished, as measured.
    reason : str
        Why it was held, or nothing.
    """

    recording: Recording
    segments: tuple[Milled, ...]
    reason: str


def mill_pocket(
    plan: FeedPlan,
    make: Callable[[], Planner],
    conduct: Conduct,
    surroundings: Surroundings,
    recorded: tuple[Signal, ...],
    about: dict[str, str],
    seconds: float = LONGEST,
) -> Pocketed:
    """Mill a pocket from its first segment to its last, or into a hold.

    Parameters
    ----------
    plan : FeedPlan
    make : callable() -> Planner
    conduct : Conduct
    surroundings : Surroundings
    recorded : tuple of Signal
        What is recorded.
    about : dict of str to str
        Provenance of the recording.
    seconds : float, s
        After so long it is held.
    """
    cell = FeedGraph(plan, make, conduct.tell, surroundings, recorded, seconds)
    left = round((plan.cell.limits.stop + AFTERWARDS) * RATE)
    rest = round((plan.cell.force_sensor.rest + LEAD) * RATE)
    conduct.advance(cell.graph, rest)
    cell.follow()
    shown = 0
    while not cell.is_done:
        conduct.advance(cell.graph, CHUNK)
        if cell.cells > shown:
            shown = cell.cells
            conduct.show(shown)
        reason = _what_is_wrong(cell, conduct, round(seconds * RATE) - left)
        if reason:
            cell.port.hold(reason)
            conduct.advance(cell.graph, left)
            break
    else:
        conduct.advance(cell.graph, rest)
    conduct.rest()
    kept = named(cell.record, recorded, about)
    return Pocketed(kept, tuple(cell.segments.done), cell.port.reason or cell.blamed)


def _what_is_wrong(cell: FeedGraph, conduct: Conduct, ticks: int) -> str:
    """Go on to the next segment where one has ended; return why it cannot go on, or nothing."""
    task = cell.plan.cell.segments
    control = cell.control
    if isinstance(control, FeedForce) and control.has_retreated:
        why = cell.blamed or control.reason
        return f"{why}; segment {cell.number}" if why else STOPPED
    if cell.blamed and (isinstance(control, ConstantFeed) or control.is_idle):
        return f"{cell.blamed}; segment {cell.number}"
    most = cell.plan.cell.force.overload
    if isinstance(control, ConstantFeed) and cell.resultant > most:
        return f"the force is beyond force.overload, {most:g} N; segment {cell.number}"
    if cell.port.reason:
        return cell.port.reason
    if conduct.stopped():
        return "" if cell.leaves() else STOPPED
    if cell.move.milling > task.patience:
        return f"segment {cell.number} is not milled after {cell.move.milling:.3g} s, must be <= {task.patience:g} s"
    if cell.graph.ticks >= ticks:
        return f"the pocket is not milled after {ticks / RATE:g} s"
    try:
        cell.advance()
    except ValueError as fault:  # of a segment that took no longer than its acceleration is said to
        return str(fault)
    return ""
