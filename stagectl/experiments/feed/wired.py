"""Force-controlled milling on the robot behind its wires: the same graph as simulated, a person beside it."""

import time
from collections.abc import Callable
from contextlib import AbstractContextManager

from ctlblocks import Graph
from rigkit.experiment.part import Part
from stagectl.devices.signals import ROBOT, Sources
from stagectl.experiments.feed.bench import Stopped
from stagectl.experiments.feed.feed_graph import FeedGraph
from stagectl.experiments.feed.job import Job
from stagectl.experiments.feed.plan import RATE, FeedPlan
from stagectl.experiments.feed.pocket_part import pocket_part
from stagectl.experiments.feed.recorded import FORCE, SLOW
from stagectl.experiments.feed.surroundings import Surroundings
from stagectl.link.tell import Tell
from stagectl.planning.beside import PATIENCE
from stagectl.planning.milling import Planner
from stagectl.robot.config import CellConfig
from stagectl.robot.live.blocks import LiveForce, LiveReference, LiveRobot
from stagectl.robot.live.led import LedRobot, Work
from stagectl.robot.live.person import Person
from stagectl.robot.live.way import room_of
from stagectl.robot.live.wires import LiveWires


class WiredBench:
    """A robot with a force sensor, and a person beside it: as of `LedRobot`."""

    patience: float | None = PATIENCE

    def __init__(self, cell: CellConfig, person: Person, clock: Callable[[], float] = time.monotonic) -> None:
        self._robot = LedRobot(cell, person, clock)

    def part(self, plan: FeedPlan, planner: Planner, tell: Tell, stopped: Stopped) -> AbstractContextManager[Part]:
        """Bring the tool to where a pocket begins, and give that, its wires open: as of `LedRobot.part`."""
        cell = self._robot.cell
        room = room_of(cell, plan.arm.with_tool(cell.robot.tool), float(plan.top[2]))
        what = f"{plan.name}: a fresh piece in its place, the spindle on, nobody in the cell"

        def make(wires: LiveWires, told: Tell) -> Part:
            return pocket_part(FeedGraph(plan, lambda: planner, told, wired(wires)))

        return self._robot.part(Work(what, True, plan.cell, room, plan.home, False, make), tell, stopped)

    def leave(self, tell: Tell, stopped: Stopped) -> None:
        """Go up from where the last pocket has ended, if it came to its end."""
        self._robot.leave(tell, stopped)


def wired(wires: LiveWires) -> Surroundings:
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
