"""Steps of the feed with the tool in the air: what the robot's velocity model is identified from."""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext

import numpy as np

from ctlblocks import Graph
from ctlblocks.basic import Gain
from ctlblocks.recording import Recording
from ctlblocks.replay import Replay
from ctlblocks.taps import Tap
from rigkit.experiment.part import Part, Phase, Retreat, Track
from rigkit.named_code import named_block
from stagectl.devices.signals import ROBOT, Sources, by_axis
from stagectl.experiments.feed.plan import RATE, FeedPlan
from stagectl.experiments.feed.pocket_part import LEAD
from stagectl.experiments.feed.recorded import SLOW
from stagectl.link.tell import Tell, nobody
from stagectl.robot.kinematics import forward
from stagectl.robot.live.blocks import LiveReference, LiveRobot
from stagectl.robot.live.led import LedRobot, Work
from stagectl.robot.live.way import room_of
from stagectl.robot.live.wires import LiveWires
from stagectl.robot.tool_place import ToolPlace
from stagectl.robot.wired_port import AFTERWARDS, WiredPort

MEAN, STEP, HELD, TURN = 0.02, 0.01, 0.04, 2.0
"""m/s, m/s, s and s: the feed steps up and down about its mean, at random, and turns round now and then."""
WAYS = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0)}
"""Axes of the base along which it goes."""
PORT_RATE = RATE / SLOW
"""samples/s, of the robot's port."""

Surroundings = Callable[[Graph, FeedPlan], Sources]


def steps(seconds: float, seed: int, rate: float) -> np.ndarray:
    """Return a feed that steps at random, back and forth about where it begins, shape (samples,), m/s."""
    sample, held = np.arange(round(seconds * rate)), round(HELD * rate)
    drawn = np.random.default_rng([seed, 71]).choice([-1.0, 1.0], len(sample) // held + 1)[sample // held]
    turn = round(TURN * rate)
    return np.asarray((MEAN + STEP * drawn) * np.where((sample + turn // 2) % (2 * turn) < turn, 1.0, -1.0))


class FreeRun:
    """Steps of the feed along an axis, above the workpiece.

    Parameters
    ----------
    plan : FeedPlan
    axis : str, of `WAYS`
    seconds : float, s
    seed : int
    """

    def __init__(self, plan: FeedPlan, axis: str, seconds: float, seed: int) -> None:
        self.plan, self._way = plan, np.array(WAYS[axis])
        self.name = f"steps-{axis}-{seconds:g}s-seed{seed}"
        rest = np.zeros(round(LEAD * PORT_RATE) + 1)
        self._feed, self._lead = np.concatenate([rest, steps(seconds, seed, PORT_RATE), rest]), len(rest)

    @property
    def seconds(self) -> float:
        """Of all of it."""
        return len(self._feed) / PORT_RATE

    def simulated(self) -> AbstractContextManager[Part]:
        """Give it on the simulated robot that the cell's file names."""
        return nullcontext(self._part(_simulated))

    def wired(self, robot: LedRobot, tell: Tell, stopped: Callable[[], bool]) -> AbstractContextManager[Part]:
        """Give it on the robot behind its wires, brought there first: as of `LedRobot.part`."""
        plan = self.plan
        what = f"steps of the feed, {self.seconds:.0f} s: no block under the tool, nobody in the cell"
        room = room_of(robot.cell, plan.arm.with_tool(plan.cell.robot.tool), float(plan.top[2]))

        def make(wires: LiveWires, told: Tell) -> Part:
            return self._part(_wired(wires), told)

        work = Work(what, False, plan.cell, room, plan.home, False, make, feels=False)
        return robot.part(work, tell, stopped)

    def velocities(self, record: Recording) -> Recording:
        """Return `velocity_reference` and `velocity`, m/s, at 250 samples/s, while it stepped.

        The velocity is that of the tool by the motors' angles, the mean since the report before; where reports are
        lost, the mean since the last one that was heard.

        Parameters
        ----------
        record : Recording
            Of the part's track.
        """
        names = [f"motor_angle_{joint}" for joint in range(1, 7)]
        place = forward(self.plan.arm.with_tool(self.plan.cell.robot.tool), record.select(names).data)[:, :3, 3]
        heard = np.flatnonzero(np.diff(record.select(["report"]).data[:, 0], prepend=-1.0) > 0)
        speed = np.diff(place[heard] @ self._way) / np.diff(heard) * record.rate
        velocity = np.zeros(len(place))
        velocity[heard[0] + 1 : heard[-1] + 1] = np.repeat(speed, np.diff(heard))
        kept = slice(self._lead, self._lead + len(self._feed) - 2 * self._lead)
        both = np.stack([record.select(["feed"]).data[:, 0], velocity], axis=1)[kept]
        return Recording(("velocity_reference", "velocity"), ("m/s", "m/s"), record.rate, both, record.provenance)

    def _part(self, surround: Surroundings, tell: Tell = nobody) -> Part:
        plan, cell, feed = self.plan, self.plan.cell, self._feed
        played = np.column_stack([feed, np.cumsum(feed)[:, None] / PORT_RATE * self._way, np.zeros((len(feed), 6))])
        names = tuple(f"channel_{n}" for n in range(played.shape[1]))
        units = ("m/s", *["m"] * 3, *["N"] * 3, *["N m"] * 3)
        ports = {"feed": names[:1], "place": names[1:4], "force": names[4:7], "moment": names[7:]}
        graph, port = Graph(RATE), WiredPort(cell, plan.home, tell)
        place = plan.top + np.array([0.0, 0.0, cell.segments.lift])
        for name, made in (
            ("steps", Replay(Recording(names, units, PORT_RATE, played), ports)),
            ("joints", ToolPlace(plan.arm, cell.robot.tool, plan.home, place)),
            ("nothing", Gain(0.0, "rad", "rad", 6)),
            ("port", port),
        ):
            graph.add(name, made, SLOW)
        sources = surround(graph, plan)
        for signal in ROBOT:
            source, delayed = sources[signal.name]
            graph.connect(source, f"port.{signal.name}", delayed=delayed)
        graph.connect("steps.place", "joints.place")
        graph.connect("joints.joint_angle", "port.nominal")
        graph.connect("joints.joint_angle", "nothing.signal")
        graph.connect("nothing.scaled", "port.correction")
        taps = [Tap("feed", "steps.feed"), *(Tap(signal.name, *sources[signal.name]) for signal in ROBOT)]
        track = Track(self.name, tuple(taps), frozenset({"feed"}), SLOW, by_axis)
        left = (len(feed) - self._lead) * SLOW
        phases = Phase("rest", self._lead * SLOW), Phase("steps", left, port.start)
        retreat = Retreat(lambda: port.reason, port.hold, round((cell.limits.stop + AFTERWARDS) * RATE))
        return Part(self.name, graph, (track,), phases, retreat=retreat)


def _simulated(graph: Graph, plan: FeedPlan) -> Sources:
    """Add the robot that the cell's file names; nothing touches it."""
    graph.add("robot", named_block(plan.cell.plants.robot, plan.plant_options()["robot"]))
    for name in ("force", "moment"):
        graph.connect(f"steps.{name}", f"robot.{name}")
    graph.connect("port.reference", "robot.reference", delayed=True)
    return {signal.name: (f"robot.{signal.name}", False) for signal in ROBOT}


def _wired(wires: LiveWires) -> Surroundings:
    """Return what adds the robot behind its wires."""

    def surround(graph: Graph, _: FeedPlan) -> Sources:
        graph.add("robot", LiveRobot(wires), SLOW)
        graph.add("sent", LiveReference(wires.port), SLOW)
        graph.connect("port.reference", "sent.reference")
        return {signal.name: (f"robot.{signal.name}", False) for signal in ROBOT}

    return surround
