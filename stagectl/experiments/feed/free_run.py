"""Steps of the feed with the tool in the air: what the robot's velocity model is identified from."""

from collections.abc import Callable

import numpy as np

from ctlblocks import Graph, Port
from ctlblocks.basic import Gain
from ctlblocks.clock import run_offline
from ctlblocks.recording import Recording
from ctlblocks.replay import Record, Replay
from rigkit.named_code import named_block
from stagectl.devices.signals import ROBOT
from stagectl.experiments.feed.feed_seen import FeedSeen
from stagectl.experiments.feed.plan import RATE, FeedPlan
from stagectl.experiments.feed.pocket_part import LEAD
from stagectl.experiments.feed.recorded import SLOW
from stagectl.robot.tool_place import ToolPlace
from stagectl.robot.wired_port import WiredPort

MEAN, STEP, HELD, TURN = 0.02, 0.01, 0.04, 2.0
"""m/s, m/s, s and s: the feed steps up and down about its mean, at random, and turns round now and then."""


def quietly(done: int) -> None:
    """Show nothing of the samples done."""


CHUNK = 125
"""Samples between two looks at how far it is."""
WAYS = {"x": (1.0, 0.0), "y": (0.0, 1.0)}
"""Axes of the base along which it goes."""


def steps(seconds: float, seed: int, rate: float) -> np.ndarray:
    """Return a feed that steps at random, back and forth about where it begins, shape (samples,), m/s."""
    sample, held = np.arange(round(seconds * rate)), round(HELD * rate)
    drawn = np.random.default_rng([seed, 71]).choice([-1.0, 1.0], len(sample) // held + 1)[sample // held]
    turn = round(TURN * rate)
    return np.asarray((MEAN + STEP * drawn) * np.where((sample + turn // 2) % (2 * turn) < turn, 1.0, -1.0))


def free_run(
    plan: FeedPlan, axis: str, seconds: float, seed: int = 1, show: Callable[[int], object] = quietly
) -> Recording:
    """Let the simulated robot feed in the air; return `velocity_reference` and `velocity`, m/s, at 250 samples/s.

    Parameters
    ----------
    plan : FeedPlan
    axis : str, of `WAYS`
    seconds : float, s
    seed : int
    show : callable(int)
        Told of the samples done, now and then.

    Raises
    ------
    ValueError : the robot was held, by its reason.
    """
    rate = RATE / SLOW
    lead = round(LEAD * rate) + 1
    feed = np.concatenate([np.zeros(lead), steps(seconds, seed, rate)])
    way = np.array(WAYS[axis])
    played = np.zeros((len(feed), 12))
    played[:, 0], played[:, 1:3], played[:, 10:] = feed, np.cumsum(feed)[:, None] / rate * way, way
    names = tuple(f"channel_{n}" for n in range(12))
    units = ("m/s", *["m"] * 3, *["N"] * 3, *["N m"] * 3, "1", "1")
    ports = {"feed": names[:1], "place": names[1:4], "force": names[4:7], "moment": names[7:10]}
    ports["direction"] = names[10:]
    graph, cell = Graph(RATE), plan.cell
    port, record = WiredPort(cell, plan.home), Record((Port("feed", "m/s"), Port("velocity", "m/s")), len(feed))
    place = plan.top + np.array([0.0, 0.0, cell.segments.lift])
    for name, made in (
        ("steps", Replay(Recording(names, units, rate, played), ports)),
        ("joints", ToolPlace(plan.arm, cell.robot.tool, plan.home, place)),
        ("nothing", Gain(0.0, "rad", "rad", 6)),
        ("port", port),
        ("seen", FeedSeen(plan.arm, cell.robot.tool)),
        ("record", record),
    ):
        graph.add(name, made, SLOW)
    graph.add("robot", named_block(cell.plants.robot, plan.plant_options()["robot"]))
    _connect(graph)
    graph.prepare()
    run_offline(graph, (lead - 1) * SLOW)
    port.start()
    samples = len(feed) - lead + 1
    for done in range(0, samples, CHUNK):
        run_offline(graph, min(CHUNK, samples - done) * SLOW)
        show(min(done + CHUNK, samples))
    if port.reason:
        raise ValueError(f"the robot was held: {port.reason}")
    return Recording(("velocity_reference", "velocity"), ("m/s", "m/s"), rate, record.recording().data[lead:])


def _connect(graph: Graph) -> None:
    """Wire path, robot and recorder; nothing touches the robot."""
    for signal in ROBOT:
        graph.connect(f"robot.{signal.name}", f"port.{signal.name}")
    for source, target in (
        ("steps.place", "joints.place"),
        ("joints.joint_angle", "port.nominal"),
        ("joints.joint_angle", "nothing.signal"),
        ("nothing.scaled", "port.correction"),
        ("robot.report", "seen.report"),
        ("robot.motor_angle", "seen.motor_angle"),
        ("steps.force", "seen.force"),
        ("steps.direction", "seen.direction"),
        ("steps.feed", "record.feed"),
        ("seen.velocity", "record.velocity"),
        ("steps.force", "robot.force"),
        ("steps.moment", "robot.moment"),
    ):
        graph.connect(source, target)
    graph.connect("port.reference", "robot.reference", delayed=True)
