"""What surrounds the controllers of the cell: the simulated plants, or a recording of what they once said."""

from collections.abc import Callable, Mapping

from ctlblocks import Graph
from ctlblocks.recording import Recording
from rigkit.named_code import named_block
from stagectl.devices.signals import LASER, PLATE, QUICK, ROBOT, TRACKER, Sources, played
from stagectl.experiments.toroid.plan import Plan
from stagectl.still import Still

Make = Callable[[Graph, Plan], Sources]
"""Adds what surrounds the controllers, which are in the graph already, and wires it to them."""


def simulated(graph: Graph, plan: Plan) -> Sources:
    """Add the plants that the cell's file names."""
    options, plants = plan.plant_options(), plan.cell.plants
    graph.add("robot", named_block(plants.robot, options["robot"]), QUICK)
    graph.add("milling", named_block(plants.cut, options["cut"]))
    graph.add("camera", named_block(plants.tracker, options["tracker"]), QUICK)
    graph.connect("port.reference", "robot.reference", delayed=True)
    for name in ("force", "moment"):
        graph.connect(f"milling.{name}", f"robot.{name}", delayed=True)
    sources = {signal.name: (f"robot.{signal.name}", False) for signal in ROBOT}
    sources |= {signal.name: (f"camera.{signal.name}", False) for signal in TRACKER}
    sources |= {"workpiece": ("camera.workpiece_seen", False)}
    sources |= {"cut": ("milling.cut", False), "force": ("milling.force", False)}
    sources |= _stage(graph, plan) if plan.has_stage else no_stage(graph, plan)
    for name in ("milling", "camera"):
        graph.connect(sources["position"][0], f"{name}.tool", delayed=sources["position"][1])
        graph.connect("robot.position", f"{name}.workpiece")
        graph.connect("robot.orientation", f"{name}.orientation")
    return sources


def recorded(recordings: Mapping[str, Recording]) -> Make:
    """Return what adds the sensors of a run's recordings.

    Parameters
    ----------
    recordings : mapping of str to Recording
        `cell` and `tracker`; with a stage, `stage`.
    """

    def add(graph: Graph, plan: Plan) -> Sources:
        parts = [("robot", "cell", ROBOT), ("camera", "tracker", TRACKER)]
        if plan.has_stage:
            parts += [("laser", "tracker", LASER), ("plant", "stage", PLATE)]
        sources = {} if plan.has_stage else dict(no_stage(graph, plan))
        for name, recording, signals in parts:
            graph.add(name, played(recordings[recording], signals), plan.pace.every[recording])
            sources |= {signal.name: (f"{name}.{signal.name}", False) for signal in signals}
        return sources

    return add


def refuse_wrong_plants(plan: Plan) -> None:
    """Build the plants that the files name once, so that a wrong option is a ValueError before anything is written."""
    options, plants = plan.plant_options(), plan.cell.plants
    for kind in ("robot", "cut", "tracker"):
        try:
            named_block(getattr(plants, kind), options[kind])
        except ValueError as fault:
            raise ValueError(_as_given(str(fault), f"{kind}_options", getattr(plants, f"{kind}_options"))) from None
    if plan.has_stage:
        named_block(plan.stage.simulator.plant, plan.stage.simulator.options)


def _as_given(fault: str, table: str, given: Mapping[str, object]) -> str:
    """Return what is wrong with an option under the name by which it was given."""
    name = fault.removeprefix("simulator.options.").partition(" ")[0]
    return fault.replace("simulator.options.", f"plants.{table}.", 1) if name in given else fault


def _stage(graph: Graph, plan: Plan) -> dict[str, tuple[str, bool]]:
    simulator = plan.stage.simulator
    graph.add("plant", named_block(simulator.plant, simulator.options))
    graph.connect("guard.voltage", "plant.voltage")
    graph.connect("milling.plate_force", "plant.force")
    graph.connect("milling.face", "plant.base")
    return {signal.name: (f"plant.{signal.name}", True) for signal in (*PLATE, *LASER)}


def no_stage(graph: Graph, plan: Plan) -> dict[str, tuple[str, bool]]:
    """Add a plate that never moves."""
    graph.add("still", Still(), plan.pace.slow)
    return {"position": ("still.base", False), "absolute": ("still.base", False)}
