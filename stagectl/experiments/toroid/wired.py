"""The cell behind its wires: robot and tracker, and with a stage that; brought to the path's beginning first."""

import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass

import numpy as np

from ctlblocks import Graph
from rigkit.experiment.part import Retreat
from rigkit.priority import undisturbed
from stagectl.devices.signals import LASER, PLATE, ROBOT, TRACKER, Sources
from stagectl.devices.wired_stage import WiredPlate, WiredPlateReference
from stagectl.experiments.toroid.makes import Make, no_stage
from stagectl.experiments.toroid.plan import Plan
from stagectl.link.stage_link import StageLink
from stagectl.link.tell import Tell
from stagectl.robot.kinematics import forward
from stagectl.robot.live.blocks import LiveReference, LiveRobot, LiveTracker
from stagectl.robot.live.way import go, room_of
from stagectl.robot.live.wires import LiveWires
from stagectl.robot.port import RobotPort
from stagectl.wire.messages import REFERENCE
from stagectl.wire.samples import largest


@dataclass(frozen=True, eq=False)
class Ends:
    """The cell's wires, while they are open.

    Parameters
    ----------
    wires : LiveWires
        Opened with the first tick.
    stage : StageLink or None
    """

    wires: LiveWires
    stage: StageLink | None

    @property
    def robot(self) -> RobotPort:
        """The robot's wire."""
        return self.wires.port

    def fault(self, within: Retreat) -> str:
        """Return what has latched, or nothing; a stage at fault holds the robot.

        Parameters
        ----------
        within : Retreat
            Of the graph, which is held for the same reason.
        """
        if self.stage is not None and self.stage.reason:
            self.robot.hold(f"the stage: {self.stage.reason}")
        if self.robot.reason:
            within.begin(self.robot.reason)
        return self.robot.reason or within.fault()

    def rest(self) -> None:
        """Hold the robot where it is, and have the stage go to mid-travel."""
        self.robot.stop()
        if self.stage is not None and not self.stage.reason:
            self.stage.halt()


def refuse_unfit(plan: Plan) -> None:
    """Refuse, by ValueError, a stage whose travel is not that of its wire, and a robot that nobody begins to guide.

    Parameters
    ----------
    plan : Plan
    """
    low, high = plan.stage.limits.travel
    middle, link = (low + high) / 2, plan.cell.link
    if plan.has_stage and not abs(link.origin - middle) <= 1e-9:
        raise ValueError(
            f"link.origin is {link.origin:g} m, must be {middle:g} m, the middle of the stage's limits.travel: "
            "give the stage's own rig file with --stage"
        )
    if plan.has_stage and not (high - low) / 2 <= largest(REFERENCE):
        raise ValueError(
            f"the stage's limits.travel is {high - low:g} m, must be <= {2 * largest(REFERENCE):.3g} m in a live run"
        )


@contextmanager
def opened(plan: Plan, tell: Tell, now: Callable[[], float] = time.monotonic) -> Iterator[Ends]:
    """Open the stage's wire; robot and tracker follow with the first tick.

    Whatever ends the block, the robot is held where it is and the stage goes to mid-travel.

    Parameters
    ----------
    plan : Plan
    tell : callable(event, fields)
        Told of faults.
    now : callable() -> float, s, a monotonic clock

    Raises
    ------
    LinkError : a wire that cannot be had.
    """
    with undisturbed(), ExitStack() as stack:
        stage = stack.enter_context(StageLink(plan.cell.link, tell)) if plan.has_stage else None
        begin = (lambda: None) if stage is None else stage.start
        wires = stack.enter_context(LiveWires(plan.cell, tell, now=now, feels=False, beside=begin))
        yield Ends(wires, stage)


def wired(ends: Ends) -> Make:
    """Return what adds robot, tracker and stage behind their wires.

    Parameters
    ----------
    ends : Ends
    """

    def add(graph: Graph, plan: Plan) -> Sources:
        slow = plan.pace.slow
        graph.add("robot", LiveRobot(ends.wires), slow)
        graph.add("camera", LiveTracker(ends.wires), plan.pace.quick)
        graph.add("sent", LiveReference(ends.robot), slow)
        graph.connect("port.reference", "sent.reference")
        sources = {signal.name: (f"robot.{signal.name}", False) for signal in ROBOT}
        sources |= {signal.name: (f"camera.{signal.name}", False) for signal in TRACKER}
        if ends.stage is None:
            return sources | no_stage(graph, plan)
        middle = sum(plan.stage.limits.travel) / 2
        graph.add("plate", WiredPlate(ends.stage, middle), slow)
        graph.add("asked", WiredPlateReference(ends.stage, middle, plan.cell.midranging.session.smoothing), slow)
        graph.connect("travel.reference", "asked.reference")
        return sources | {signal.name: (f"plate.{signal.name}", False) for signal in (*PLATE, *LASER)}

    return add


def bring(plan: Plan, tell: Tell, stopped: Callable[[], bool], now: Callable[[], float] = time.monotonic) -> None:
    """Lead the workpiece, joint by joint, to where the path begins; it must be near it.

    Parameters
    ----------
    plan : Plan
    tell : callable(event, fields)
        Told of faults.
    stopped : callable() -> bool
    now : callable() -> float, s, a monotonic clock

    Raises
    ------
    ValueError : it is further away than the box around the path.
    LinkError : the robot is not there, or a fault; it is held.
    Stopped : it was asked to; the robot is held.
    """
    arm, limits = plan.arm, plan.cell.limits
    there = plan.path.joints(arm, np.zeros(1))[0]
    room = room_of(plan.cell, arm, 0.0)

    def way(here: np.ndarray) -> np.ndarray:
        at = forward(arm, here)[:3, 3]
        if not ((at >= limits.lowest) & (at <= limits.highest)).all():
            wanted = ", ".join(f"{angle:.3f}" for angle in there)
            raise ValueError(
                f"the robot has the workpiece at {_millimetres(at)} mm, must be from {_millimetres(limits.lowest)} to "
                f"{_millimetres(limits.highest)}, the box around the toroid's path: bring it near the joints {wanted} "
                "rad first"
            )
        return room.leg(here, there, False)

    go(plan.cell, way, tell, stopped, now)


def _millimetres(place: np.ndarray | tuple[float, float, float]) -> str:
    return ", ".join(f"{1e3 * each:.0f}" for each in place)
