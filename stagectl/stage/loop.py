"""The stage as a whole: sensor check, controller and guard wired in a graph, started, held, stopped and cleared."""

from collections.abc import Sequence

from ctlblocks import Block, Graph
from stagectl.config import StageConfig
from stagectl.stage.controller import PiezoController, StageController
from stagectl.stage.guard import VoltageGuard
from stagectl.stage.piezo_pid import Pid, pid
from stagectl.stage.sensors import SensorCheck
from stagectl.stage.state_feedback import StateFeedback


class Stage:
    """The stage's blocks in a graph: `sensors`, `controller`, `guard`, and `compensation` where there is one.

    Whoever owns the graph wires `sensors.position`, `sensors.extension` and the controller's reference to their sources
    and reads `guard.voltage`.  What a method here does, it does at once: call it between ticks, or hand it to
    `Graph.changes`.

    Parameters
    ----------
    graph : Graph
        Not prepared yet.
    config : StageConfig
    controller : StageController or PiezoController
    compensation : Block, optional
        In series behind the inner loop, its first input and output (V): what undoes the piezos' hysteresis.
    """

    def __init__(
        self,
        graph: Graph,
        config: StageConfig,
        controller: StageController | PiezoController,
        compensation: Block | None = None,
    ) -> None:
        axes = len(config.stage.axes)
        self.sensors = SensorCheck(config.sensors, axes)
        self.controller = controller
        self.guard = VoltageGuard(config.limits, axes)
        graph.add("sensors", self.sensors)
        graph.add("controller", controller)
        graph.add("guard", self.guard)
        request, self._compensated = "controller.request", compensation is not None
        if compensation is not None:
            graph.add("compensation", compensation)
            graph.connect(request, f"compensation.{compensation.inputs[0].name}")
            request = f"compensation.{compensation.outputs[0].name}"
        graph.connect(request, "guard.request")
        graph.connect("sensors.fault", "guard.fault")
        graph.connect("sensors.valid_extension", "controller.extension")
        if isinstance(controller, StageController):
            graph.connect("sensors.valid_position", "controller.position")

    def start(self) -> None:
        """Begin to control, without a step; ValueError unless the voltages are at rest and nothing is latched."""
        if self._compensated:
            self.guard.ease_open()
        else:
            self.guard.open()
        self.controller.start(self.guard.voltage)

    def stop(self) -> None:
        """Take all voltages to rest."""
        self.guard.close()
        self.controller.stop()

    def clear(self, by: str) -> str:
        """Clear a fault in the name of the person who looked, and return it; the stage is then stopped.

        Raises
        ------
        ValueError : nobody is named, nothing is latched, or the way to rest is not over.
        """
        fault = self.fault
        self.guard.clear(by)
        self.sensors.clear()
        self.controller.stop()
        return str(fault)

    @property
    def fault(self) -> str | None:
        """What latched the guard, in a line, or None."""
        return fault_of(self.sensors, self.guard)


def fault_of(sensors: SensorCheck, guard: VoltageGuard) -> str | None:
    """Return what latched a guard, in a line: what the sensor did where it was one; None if nothing did."""
    if sensors.fault is not None and guard.latched:
        return str(sensors.fault)
    return guard.cause


def stage_controller(config: StageConfig, outer: Sequence[StateFeedback]) -> StageController:
    """Return the controller of a rig file: its PIDs, and outer loops, one an axis."""
    return StageController(inner_loops(config), outer, config.limits)


def inner_loops(config: StageConfig) -> list[Pid]:
    """Return the PIDs of a rig file, one an axis."""
    return [pid(config.inner, axis) for axis in range(len(config.stage.axes))]
