"""A pocket milled segment by segment; whatever goes wrong ends in a retreat or a hold, and a named reason."""

from rigkit.experiment.part import Part, Phase, Retreat
from rigkit.experiment.runner import STOPPED
from stagectl.experiments.feed.constant_feed import ConstantFeed
from stagectl.experiments.feed.feed_graph import FeedGraph
from stagectl.experiments.feed.plan import RATE
from stagectl.experiments.feed.recorded import SLOW
from stagectl.robot.milling.feed_force import FeedForce
from stagectl.robot.wired_port import AFTERWARDS

LEAD = 0.2
"""s at rest, beside those in which zero force is taken, before the robot follows, and at the end."""
CHUNK = 5 * SLOW
"""Ticks between two looks at faults and at the planner: 20 ms."""
LONGEST = 600.0
"""s of a pocket; after so long it is held."""


def pocket_part(cell: FeedGraph, seconds: float = LONGEST) -> Part:
    """Return a pocket from its first segment to its last, or into a hold.

    Parameters
    ----------
    cell : FeedGraph
        Not prepared.
    seconds : float, s
        After so long it is held.
    """
    return _Course(cell, seconds).part


class _Course:
    """What happens in which order."""

    def __init__(self, cell: FeedGraph, seconds: float) -> None:
        self._cell, self._is_led = cell, False
        self._left = round((cell.plan.cell.limits.stop + AFTERWARDS) * RATE)
        self._most, self._held = round(seconds * RATE) - self._left, -1
        rest = round((cell.plan.cell.force_sensor.rest + LEAD) * RATE)
        phases = (
            Phase("rest", rest, cell.take_feed),
            Phase("mill", round(seconds * RATE), self._follow, every=CHUNK, look=self._go_on),
            Phase("end", rest),
        )
        patience = self._left + round(cell.plan.cell.segments.patience * RATE)
        retreat = Retreat(self._fault, self._leave, patience, CHUNK, self._is_at_rest)
        self.part = Part(
            cell.plan.name, cell.graph, (cell.track(),), phases, None, retreat,
            about=cell.plan.about, progress=lambda: float(cell.cells),
        )  # fmt: skip

    def _fault(self) -> str:
        return self._cell.port.reason or (self._cell.blamed if self._cell.is_done else "")

    def _follow(self) -> None:
        self._is_led = True
        self._cell.follow()

    def _go_on(self) -> bool:
        """Go on to the next segment where one has ended, or hold; return whether all is milled."""
        cell = self._cell
        reason = self._wrong()
        if not reason:
            try:
                cell.advance()
            except ValueError as fault:  # of a segment that took no longer than its acceleration is said to
                reason = str(fault)
        if reason:
            cell.port.hold(reason)
        return not reason and cell.is_done

    def _wrong(self) -> str:
        """Return why it cannot go on, or nothing."""
        cell, control, task = self._cell, self._cell.control, self._cell.plan.cell.segments
        if reason := self._retreated():
            return reason
        if cell.blamed and (isinstance(control, ConstantFeed) or control.is_idle):
            return f"{cell.blamed}; segment {cell.number}"
        most = cell.plan.cell.force.overload
        if isinstance(control, ConstantFeed) and cell.resultant > most:
            return f"the force is beyond force.overload, {most:g} N; segment {cell.number}"
        if cell.port.reason:
            return cell.port.reason
        if cell.move.milling > task.patience:
            took = f"{cell.move.milling:.3g} s"
            return f"segment {cell.number} is not milled after {took}, must be <= {task.patience:g} s"
        if cell.graph.ticks >= self._most:
            return f"the pocket is not milled after {self._most / RATE:g} s"
        return ""

    def _retreated(self) -> str:
        """Return why the tool has gone back along its strip, or nothing while it has not."""
        control = self._cell.control
        if not (isinstance(control, FeedForce) and control.has_retreated):
            return ""
        why = self._cell.blamed or control.reason
        return f"{why}; segment {self._cell.number}" if why else STOPPED

    def _leave(self, reason: str) -> None:
        """Have the tool go back along its strip, or hold the robot where there is none."""
        if self._is_led and not self._cell.port.reason and not self._cell.leaves():
            self._cell.port.hold(self._cell.blamed or reason)

    def _is_at_rest(self) -> bool:
        """Hold the robot once the tool has gone back; return whether it has been held for long enough."""
        cell = self._cell
        if not self._is_led:
            return True
        if not cell.port.reason and (reason := self._retreated()):
            cell.port.hold(reason)
        if cell.port.reason and self._held < 0:
            self._held = cell.graph.ticks
        return 0 <= self._held <= cell.graph.ticks - self._left
