"""What surrounds the controllers of force-controlled milling: the simulated cell, or a recording of what it said."""

from collections.abc import Callable

from ctlblocks import Block, Graph
from ctlblocks.recording import Recording
from ctlblocks.replay import Replay
from rigkit.named_code import named_block
from stagectl.devices.signals import ROBOT, Sources
from stagectl.experiments.feed.plan import FeedPlan
from stagectl.experiments.feed.recorded import FORCE, SLOW

Surroundings = Callable[[Graph, FeedPlan], Sources]
"""Adds what surrounds the controllers, which are in the graph already, and wires it to them."""
GIVE = "give"
"""Input of a cut that finds speed and force together: by what a force moves the tool at once."""


def simulated(graph: Graph, plan: FeedPlan) -> Sources:
    """Add the plants that the cell's file names."""
    plants = plants_of(plan)
    for name, made in plants.items():
        graph.add(name, made)
    if GIVE in [port.name for port in plants["cut"].inputs]:
        graph.connect(f"robot.{GIVE}", f"cut.{GIVE}")
    graph.connect("port.reference", "robot.reference", delayed=True)
    for name in ("force", "moment"):
        graph.connect(f"cut.{name}", f"robot.{name}", delayed=True)
    graph.connect("robot.position", "cut.tool")
    graph.connect("cut.teeth_force", "sensor.force")
    graph.connect("cut.moment", "sensor.moment")
    sources = {signal.name: (f"robot.{signal.name}", False) for signal in ROBOT}
    sources |= {signal.name: (f"sensor.{signal.name}", False) for signal in FORCE}
    sources |= {"tool": ("robot.position", False), "true_force": ("cut.force", False)}
    return sources | {f"true_{name}": (f"cut.{name}", False) for name in ("kappa", "beta")}


def recorded(record: Recording) -> Surroundings:
    """Return what adds the sensors of a run's recording."""

    def surround(graph: Graph, _: FeedPlan) -> Sources:
        signals = (*ROBOT, *FORCE)
        graph.add("recorded", Replay(record, {signal.name: signal.channels for signal in signals}), SLOW)
        return {signal.name: (f"recorded.{signal.name}", False) for signal in signals}

    return surround


def plants_of(plan: FeedPlan) -> dict[str, Block]:
    """Build robot, cut and force sensor as the file names them; ValueError for an option that one does not take."""
    options, cell = plan.plant_options(), plan.cell
    names = {"robot": cell.plants.robot, "cut": cell.feed_plants.cut, "sensor": cell.plants.force_sensor}
    return {each: named_block(name, options[each]) for each, name in names.items()}
