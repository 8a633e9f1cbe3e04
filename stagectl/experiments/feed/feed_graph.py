"""The graph of force-controlled milling: planner, way, feed and robot port at 250 Hz, robot and cut at 2 kHz."""

from collections.abc import Callable

from ctlblocks import Graph
from ctlblocks.basic import Gain
from ctlblocks.taps import Tap
from rigkit.experiment.part import Track
from stagectl.devices.signals import ROBOT, by_axis
from stagectl.experiments.feed.constant_feed import ConstantFeed
from stagectl.experiments.feed.feed_seen import FeedSeen
from stagectl.experiments.feed.plan import RATE, FeedPlan
from stagectl.experiments.feed.recorded import FORCE, SLOW, TRUE, made
from stagectl.experiments.feed.segment_move import SegmentMove
from stagectl.experiments.feed.surroundings import Surroundings
from stagectl.link.tell import Tell
from stagectl.planning.milling import Planner
from stagectl.planning.segments import Segments
from stagectl.robot.milling.feed_force import FeedForce
from stagectl.robot.milling.feed_notices import words
from stagectl.robot.milling.feed_record import CONTROLLING
from stagectl.robot.tool_place import ToolPlace
from stagectl.robot.wired_force import WiredForce
from stagectl.robot.wired_port import WiredPort


class FeedGraph:
    """The cell in a graph of one sample a tick.

    Parameters
    ----------
    plan : FeedPlan
    make : callable() -> Planner
        Called once.
    tell : callable(event, fields)
        Told of faults.
    surroundings : Surroundings
    """

    def __init__(self, plan: FeedPlan, make: Callable[[], Planner], tell: Tell, surroundings: Surroundings) -> None:
        self.plan, self.graph, cell = plan, Graph(RATE), plan.cell
        self.segments = Segments(plan.pocket, make)
        self.move = SegmentMove(cell.segments, plan.pocket)
        self.port = WiredPort(cell, plan.home, tell)
        self.judged = WiredForce(cell.force_sensor, self._blame)
        self.blamed, self._tell, self._notice = "", tell, 0
        self.control: FeedForce | ConstantFeed = (
            FeedForce(cell.force, plan.model)
            if plan.feeds is None
            else ConstantFeed(cell.force.acceleration, CONTROLLING)
        )
        for name, block in (
            ("segments", self.segments),
            ("move", self.move),
            ("judged", self.judged),
            ("seen", FeedSeen(plan.arm, cell.robot.tool)),
            ("control", self.control),
            ("joints", ToolPlace(plan.arm, cell.robot.tool, plan.home, plan.corner)),
            ("nothing", Gain(0.0, "rad", "rad", 6)),
            ("port", self.port),
        ):
            self.graph.add(name, block, SLOW)
        self._sources = dict(surroundings(self.graph, plan))
        self._connect()

    def track(self) -> Track:
        """Return what is recorded: the truth where it is known."""
        true = TRUE if TRUE[0].source in self._sources else ()
        own = made(self.plan.control)
        taps = [
            Tap(each.name, *self._sources.get(each.source, (each.source, False)))
            for each in (*ROBOT, *FORCE, *true, *own)
        ]
        return Track(self.plan.name, tuple(taps), frozenset(each.name for each in own), SLOW, by_axis)

    def advance(self) -> None:
        """Let the planner choose the next segment, where one has ended (between ticks)."""
        self.segments.advance()
        self.take_feed()
        self._notify()

    def _notify(self) -> None:
        """Report what force control has noticed since it was asked last."""
        if not isinstance(self.control, FeedForce):
            return
        bits = self.control.notice
        for what in words(bits & ~self._notice):
            time, ripple = self.graph.ticks / RATE, round(self.control.ripple, 1)
            self._tell("noticed", {"part": self.plan.name, "time_s": time, "segment": self.number, "what": what,
                                   "ripple_hz": ripple})  # fmt: skip
        self._notice = bits

    def follow(self) -> None:
        """Let the robot follow, and have the force sensor watched (between ticks)."""
        self.port.start()
        self.judged.start()

    def leaves(self) -> bool:
        """Have the tool retreat from a strip (between ticks); return whether it does."""
        if isinstance(self.control, FeedForce) and not self.control.is_idle:
            self.control.retreat()
            return True
        return False

    def _blame(self, reason: str) -> None:
        """Keep what is wrong with the force sensor; force control retreats for want of a valid force."""
        self.blamed = self.blamed or reason

    @property
    def is_done(self) -> bool:
        """Whether all is milled and the tool is away."""
        return self.graph.ticks > 0 and self.number == 0 and self.move.is_at_rest

    @property
    def number(self) -> int:
        """Of the segment in hand, from 1; 0 when all is milled."""
        return int(self.graph.signal("segments.number")[0, 0])

    @property
    def resultant(self) -> float:
        """The force on the tool in the plane, N; 0 until zero force is known."""
        return float(self.graph.signal("control.resultant")[0, 0]) if self.judged.inbox.is_tared else 0.0

    @property
    def cells(self) -> int:
        """How many are milled."""
        done, pocket = self.segments.done, self.plan.pocket
        left = done[-1].leaves().uncut if done else (0, pocket.rows, 0, pocket.cols)
        return pocket.rows * pocket.cols - max(left[1] - left[0], 0) * max(left[3] - left[2], 0)

    def take_feed(self) -> None:
        """Set the feed of position control to that of the segment in hand."""
        name = self.segments.name
        if isinstance(self.control, ConstantFeed) and self.plan.feeds is not None and name:
            self.control.change(self.plan.feeds[name])

    def _connect(self) -> None:
        for signal in ROBOT:
            self._wire(signal.name, f"port.{signal.name}")
        for name in ("report", "motor_angle"):
            self._wire(name, f"seen.{name}")
        for signal in FORCE:
            self._wire(signal.name, f"judged.{signal.name}")
        for name in ("number", "start", "stop", "lift"):
            self.graph.connect(f"segments.{name}", f"move.{name}")
        for name in ("is_finished", "duration", "force_deviation"):
            self.graph.connect(f"move.{name}", f"segments.{name}", delayed=True)
        for source, target in (
            ("judged.force", "seen.force"),
            ("judged.valid", "control.is_valid"),
            ("seen.velocity", "control.velocity"),
            ("seen.along", "control.force"),
            ("control.reference", "move.feed"),
            ("control.resultant", "move.resultant"),
            ("control.phase", "move.phase"),
            ("move.place", "joints.place"),
            ("joints.joint_angle", "port.nominal"),
            ("joints.joint_angle", "nothing.signal"),
            ("nothing.scaled", "port.correction"),
        ):
            self.graph.connect(source, target)
        for source, target in (
            ("move.direction", "seen.direction"),
            ("move.is_resting", "judged.resting"),
            ("move.is_running", "control.is_running"),
            ("port.holding", "move.holding"),
        ):
            self.graph.connect(source, target, delayed=True)

    def _wire(self, source: str, target: str) -> None:
        output, delayed = self._sources.get(source, (source, False))
        self.graph.connect(output, target, delayed=delayed)
