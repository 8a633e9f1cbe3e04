"""What surrounds the path and the port of a trial: the simulated plants, or a recording of what they once said."""

from collections.abc import Callable, Mapping

from ctlblocks import Graph
from ctlblocks.recording import Recording
from rigkit.named_code import named_block
from stagectl.devices.signals import ROBOT, TRACKER, Sources, played
from stagectl.experiments.trials.recorded import EVERY, FORCE, SLOW, TORQUE
from stagectl.experiments.trials.trial import Trial
from stagectl.still import Still

Surroundings = Callable[[Graph, Trial], Sources]
"""Adds what surrounds the path and the port, which are in the graph already, and wires it to them."""


def simulated(graph: Graph, trial: Trial) -> Sources:
    """Add the plants that the cell's file names: robot, tracker, force sensor; the cut where there is a block."""
    options, plants = trial.plant_options(), trial.cell.plants
    graph.add("robot", named_block(plants.robot, options["robot"]))
    graph.add("camera", named_block(plants.tracker, options["tracker"]))
    graph.add("fixture", Still(), SLOW)
    graph.connect("port.reference", "robot.reference", delayed=True)
    graph.connect("fixture.base", "camera.tool")
    graph.connect("robot.position", "camera.workpiece")
    graph.connect("robot.orientation", "camera.orientation")
    if trial.is_milled:
        graph.add("cut", named_block(plants.pocket, options["cut"]))
        graph.connect("robot.position", "cut.tool")
        graph.connect("robot.give", "cut.give")
    else:
        graph.add("cut", Still(), SLOW)
    graph.add("sensor", named_block(plants.force_sensor, options["sensor"]))
    for name in ("force", "moment"):
        graph.connect(f"cut.{name}", f"robot.{name}", delayed=True)
        graph.connect(f"cut.{name}", f"sensor.{name}")
    sources = {signal.name: (f"robot.{signal.name}", False) for signal in (*ROBOT, TORQUE)}
    sources |= {signal.name: (f"camera.{signal.name}", False) for signal in TRACKER}
    return sources | {
        "workpiece": ("camera.workpiece_seen", False),
        "position": ("robot.position", False),
        "force": ("cut.force", False),
        "wrench": ("sensor.measured", False),
        "force_sample": ("sensor.sample", False),
        "force_status": ("sensor.status", False),
    }


def recorded(recordings: Mapping[str, Recording]) -> Surroundings:
    """Return what adds the sensors of a trial's recordings.

    Parameters
    ----------
    recordings : mapping of str to Recording
        By name, as `recorded.RECORDED` has them.
    """

    def surround(graph: Graph, _: Trial) -> Sources:
        sources: dict[str, tuple[str, bool]] = {}
        for name, recording, signals in (
            ("robot", "trial", (*ROBOT, TORQUE)),
            ("camera", "tracker", (*TRACKER, *FORCE)),
        ):
            graph.add(name, played(recordings[recording], signals), EVERY[recording])
            sources |= {signal.name: (f"{name}.{signal.name}", False) for signal in signals}
        return sources

    return surround


def refuse_wrong_plants(trial: Trial) -> None:
    """Build the plants that the file names once, so that a wrong option is a ValueError before anything is written."""
    options, plants = trial.plant_options(), trial.cell.plants
    names = {"robot": plants.robot, "cut": plants.pocket, "tracker": plants.tracker, "sensor": plants.force_sensor}
    for given, name in names.items():
        named_block(name, options[given])
