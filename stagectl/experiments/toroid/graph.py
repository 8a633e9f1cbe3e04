"""The netlist of the cell: stage at 10 kHz or behind its wire, tracker at 2 kHz, port and mid-ranging at 250 Hz."""

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

import numpy as np

from ctlblocks import Graph
from ctlblocks.basic import Gain
from ctlblocks.recording import Recording
from ctlblocks.replay import Replay
from ctlblocks.taps import Tap
from rigkit.experiment.part import Track
from stagectl.devices.signals import LASER, PLATE, ROBOT, TRACKER, by_axis
from stagectl.experiments.toroid.makes import Make
from stagectl.experiments.toroid.plan import TOUCH_OFF, Plan
from stagectl.experiments.toroid.relative_position import RelativePosition
from stagectl.experiments.toroid.stage_reference import StageReference
from stagectl.experiments.toroid.standstill import Standstill
from stagectl.link.tell import Tell
from stagectl.robot.cartesian_correction import CartesianCorrection
from stagectl.robot.kept_orientation import KeptOrientation
from stagectl.robot.midranging.valve_position import ValvePosition
from stagectl.robot.port import arm_of
from stagectl.robot.wired_port import WiredPort
from stagectl.robot.wired_tracker import WiredTracker
from stagectl.stage.loop import Stage, stage_controller

MADE = {
    "cell": {
        "deviation": "relative.deviation",
        "fast_reference": "midranging.fast_reference",
        "slow_reference": "midranging.slow_reference",
        "correction": "correction.correction",
        "reference": "port.reference",
        "holding": "port.holding",
    },
    "stage": {
        "reference": "travel.reference",
        "extension_reference": "controller.extension_reference",
        "voltage": "guard.voltage",
    },
}
"""What the controllers make of what the sensors say, by recording."""
BEYOND = "extension_reference", "voltage"
"""Of these, what is made beyond the wire of a live stage."""


class CellGraph:
    """The cell in a graph of one sample a tick.

    Parameters
    ----------
    plan : Plan
    tell : callable(event, fields)
        Told of faults.
    make : callable(Graph, Plan) -> Sources
        Adds what surrounds the controllers.
    """

    def __init__(self, plan: Plan, tell: Tell, make: Make) -> None:
        self.plan = plan
        self.graph = Graph(plan.pace.rate)
        self._add(tell)
        self._sources = dict(make(self.graph, plan))
        self._connect_sensors()
        self._connect_controllers()
        if self.stage is not None:
            self._connect_stage()
        if plan.has_stage:
            self.graph.connect("midranging.fast_reference", "travel.fast_reference")

    def tracks(self) -> Iterator[Track]:
        """Give what is recorded: of the surface, nothing where there is none but in a recording."""
        said = {"cell": ["nominal", *(signal.name for signal in ROBOT)], "tracker": [signal.name for signal in TRACKER]}
        if "cut" in self._sources:
            said["surface"] = ["cut", "wanted", "force"]
        if self.plan.has_stage:
            said["tracker"] += [signal.name for signal in LASER]
            said["stage"] = [signal.name for signal in PLATE]
        own = {"nominal": "path.nominal", "wanted": "wanted.position"}
        for name, words in said.items():
            made = {
                word: source
                for word, source in MADE.get(name, {}).items()
                if not (self.plan.is_live and name == "stage" and word in BEYOND)
            }
            taps = [Tap(word, *self._sources.get(word, (own.get(word, word), False))) for word in words]
            taps += [Tap(word, source) for word, source in made.items()]
            yield Track(f"{self.plan.setup}-{name}", tuple(taps), frozenset(made), self.plan.pace.every[name], by_axis)

    def follow(self) -> None:
        """Let the robot follow its path, with tracker and stage (between ticks); a fault latches."""
        self.port.start()
        self.seen.start()

    def fault(self) -> str:
        """Return why the robot is held, or nothing; where the stage is at fault, hold it (between ticks)."""
        if self.stage is not None and self.stage.fault is not None:
            self.port.hold(f"the stage: {self.stage.fault}")
        return self.port.reason

    def figures(self) -> dict[str, Any]:
        """Return what the blocks have counted."""
        spindle, workpiece = self.seen.counts
        found: dict[str, Any] = {"tracker": {"spindle": asdict(spindle), "workpiece": asdict(workpiece)}}
        if self.plan.has_stage:
            found["samples_at_end"] = self.travel.samples_at_end
        return found

    def _add(self, tell: Tell) -> None:
        graph, plan, cell = self.graph, self.plan, self.plan.cell
        pace = plan.pace
        quick, slow = pace.quick, pace.slow
        times = np.arange(round(plan.path.seconds * pace.rate / quick)) * quick / pace.rate
        nominal = plan.path.joints(plan.arm, times[:: slow // quick])
        self.port = WiredPort(cell, nominal[0], tell)
        self.seen = WiredTracker(cell.tracker, self.port.hold)
        between = TOUCH_OFF[0], cell.toroid.lead - TOUCH_OFF[1]
        graph.add("path", _played("nominal", "rad", pace.rate / slow, nominal), slow)
        graph.add(
            "wanted", _played("position", "m", pace.rate / quick, plan.path.wanted(times - cell.feedback.lag)), quick
        )
        graph.add("seen", self.seen, quick)
        graph.add("relative", RelativePosition(plan.corners, plan.by_laser, cell.feedback.delay, *between), quick)
        graph.add("standstill", Standstill(), slow)
        graph.add("midranging", ValvePosition(plan.controllers()), slow)
        graph.add("wish", Gain(1.0, "m", "m/s", 3), slow)
        graph.add("moved", Gain(plan.robot_share, "m", "m", 3), slow)
        graph.add("upright", KeptOrientation(plan.turning, *between), slow)
        graph.add("correction", CartesianCorrection(arm_of(cell), cell.robot.tool), slow)
        graph.add("port", self.port, slow)
        self.stage: Stage | None = None
        if plan.has_stage:
            if not plan.is_live:
                self.stage = Stage(graph, plan.stage, stage_controller(plan.stage, plan.loops))
            patience = cell.feedback.saturated if plan.has_mid_ranging else np.inf
            self.travel = StageReference(plan.stage.limits.travel, patience, plan.stage.stage.axes, self.port.hold)
            graph.add("travel", self.travel, slow)

    def _connect_sensors(self) -> None:
        for signal in ROBOT:
            self._wire(signal.name, f"port.{signal.name}")
        for signal in TRACKER:
            self._wire(signal.name, f"seen.{signal.name}")
        self._wire("motor_angle", "correction.joint_angle")
        self._wire("sensors.valid_position" if self.stage is not None else "position", "relative.position")
        self._wire("absolute", "relative.absolute")
        self._wire("seen.spindle_position", "relative.spindle")
        self._wire("seen.workpiece_position", "relative.workpiece")
        self._wire("wanted.position", "relative.wanted")

    def _connect_controllers(self) -> None:
        slow = f"midranging.{'slow' if self.plan.has_stage else 'fast'}_reference"
        self.graph.connect("port.holding", "standstill.holding", delayed=True)
        self.graph.connect("port.holding", "upright.holding", delayed=True)
        self.graph.connect("wish.scaled", "midranging.control", delayed=True)
        for source, target in (
            ("standstill.reference", "midranging.reference"),
            ("relative.deviation", "midranging.relative"),
            ("midranging.fast_reference", "wish.signal"),
            (slow, "moved.signal"),
            ("moved.scaled", "correction.translation"),
            ("seen.workpiece_orientation", "upright.orientation"),
            ("upright.rotation", "correction.rotation"),
            ("path.nominal", "port.nominal"),
            ("correction.correction", "port.correction"),
        ):
            self.graph.connect(source, target)

    def _connect_stage(self) -> None:
        for name in ("position", "extension"):
            self._wire(name, f"sensors.{name}")
        self.graph.connect("travel.reference", "controller.reference")

    def _wire(self, source: str, target: str) -> None:
        output, delayed = self._sources.get(source, (source, False))
        self.graph.connect(output, target, delayed=delayed)


def _played(name: str, unit: str, rate: float, data: np.ndarray) -> Replay:
    names = tuple(f"{name}_{column + 1}" for column in range(data.shape[1]))
    return Replay(Recording(names, (unit,) * len(names), rate, data), {name: names})
