"""Force-controlled milling on the robot behind its wires: the same graph as simulated, a person beside it."""

import time
from collections.abc import Callable

from ctlblocks import Graph
from rigkit.priority import real_time, undisturbed
from stagectl.devices.signals import ROBOT, Sources
from stagectl.feed.job import Job, once
from stagectl.feed.plan import RATE, FeedPlan
from stagectl.feed.recorded import FORCE, SLOW, made
from stagectl.feed.run import Pocketed, mill_pocket
from stagectl.feed.session import about
from stagectl.feed.surroundings import Surroundings
from stagectl.planning.milling import Planner
from stagectl.robot.config import CellConfig
from stagectl.robot.live.blocks import LiveForce, LiveReference, LiveRobot
from stagectl.robot.live.guide import Guide
from stagectl.robot.live.person import Person
from stagectl.robot.live.way import room_of
from stagectl.robot.live.wires import LiveWires
from stagectl.trials.conduct import Conduct
from stagectl.trials.led import led


class LivePockets:
    """Mills pocket after pocket on a robot: `session.Perform`.

    Parameters
    ----------
    cell : CellConfig
        Its limits hold on the way to a pocket; in a pocket, those of its plan.
    person : Person
    clock : callable() -> float, s, monotonic
    """

    def __init__(self, cell: CellConfig, person: Person, clock: Callable[[], float] = time.monotonic) -> None:
        self._cell, self._guide = cell, Guide(cell, person, clock)

    def __call__(self, plan: FeedPlan, planner: Planner, conduct: Conduct) -> Pocketed:
        """Mill a pocket.

        Raises
        ------
        ValueError, LinkError, Stopped : as of `Guide.bring`, before the pocket is begun.
        """
        room = room_of(self._cell, plan.arm.with_tool(self._cell.robot.tool), float(plan.top[2]))
        what = f"{plan.name}: a fresh piece in its place, the spindle on, nobody in the cell"
        self._guide.bring(what, True, room, plan.home, conduct.tell, conduct.stopped)
        signals = (*ROBOT, *FORCE, *made(plan.control))
        with undisturbed(), real_time(), LiveWires(plan.cell, conduct.tell, False, self._guide.clock) as wires:
            told = about(plan) | {"cell": "live"}
            came = mill_pocket(plan, once(planner), led(conduct, wires, SLOW), live(wires), signals, told)
            reason = wires.port.reason or came.reason
        if not reason:
            self._guide.finished(room)
        return Pocketed(came.recording, came.segments, reason)

    def leave(self, conduct: Conduct) -> None:
        """Go up from where the last pocket has ended, if it came to its end."""
        self._guide.leave(conduct.tell, conduct.stopped)


def live(wires: LiveWires) -> Surroundings:
    """Return what adds the robot and the force sensor behind their wires.

    Parameters
    ----------
    wires : LiveWires
    """

    def surround(graph: Graph, _: FeedPlan) -> Sources:
        graph.add("robot", LiveRobot(wires), SLOW)
        graph.add("sensor", LiveForce(wires.records), SLOW)
        graph.add("sent", LiveReference(wires.port), SLOW)
        graph.connect("port.reference", "sent.reference")
        sources = {signal.name: (f"robot.{signal.name}", False) for signal in ROBOT}
        return sources | {signal.name: (f"sensor.{signal.name}", False) for signal in FORCE}

    return surround


def steps(plan: FeedPlan, job: Job) -> list[str]:
    """Return in words all that moves in a live run, in order.

    Parameters
    ----------
    plan : FeedPlan
        Of the first pocket.
    job : Job
    """
    task, robot, pocket, top = plan.cell.segments, plan.cell.robot, plan.pocket, 1e3 * plan.top
    size = (1e3 * task.cell * each for each in (pocket.cols, pocket.rows))
    changes = "the robot's program puts it there" if robot.changer else "a person puts it there"
    found = [
        f"before each pocket: straight up to {1e3 * robot.height:g} mm over the surface, z = {top[2]:.1f} mm in the "
        f"base, across to x = {top[0]:.1f}, y = {top[1]:.1f} mm, down to {1e3 * task.lift:g} mm over it; at most "
        f"{1e3 * robot.travel:g} mm/s",
        f"{job.pockets} pocket{'s' * (job.pockets > 1)} of {' x '.join(f'{each:g}' for each in size)} mm, "
        f"{1e3 * task.depth:g} mm deep, {plan.cell.force.force:g} N wanted, at most "
        f"{1e3 * plan.cell.force.highest:g} mm/s; a fresh piece each, {changes}",
    ]
    if job.compares:
        found.append("the last one once more in another fresh piece, by position control at the safe feed")
    return [*found, f"after each pocket: straight up to {1e3 * robot.height:g} mm over the surface"]


assert RATE == SLOW * 250.0
