"""One axis of the stage excited in a graph: its stack by a voltage, or its inner loop by a reference, guarded."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from calibration.experiment import refuse_to_emit
from ctlblocks import Graph, Port
from ctlblocks.clock import run_offline
from ctlblocks.recording import Recording
from ctlblocks.replay import Record, Replay
from rigkit.stop import Stopped
from stagectl.config import StageConfig
from stagectl.experiments.piezo.cell import CHUNK, simulated
from stagectl.stage.controller import PiezoController
from stagectl.stage.guard import VoltageGuard
from stagectl.stage.loop import Stage, fault_of
from stagectl.stage.piezo_pid import Pid
from stagectl.stage.sensors import SensorCheck

HEARD = ("extension", "position", "absolute")
"""What is recorded of every axis, m: the last by a laser, zeros where there is none."""
CONTROLLED = HEARD[:2]
"""What the controllers read of it."""
_PUSHES = "surroundings", "surroundings_options"


class ExcitationError(ValueError):
    """The guard shut the stage, or the plate left its travel."""


class ExcitedAxis(Protocol):
    """One axis of a stage that can be excited: `Bench`, in process, or `LiveBench`, over the link."""

    @property
    def config(self) -> StageConfig:
        """The rig file."""

    @property
    def axis(self) -> int:
        """Which, counted from 0."""

    @property
    def loop(self) -> Pid | None:
        """The axis' inner loop, whose reference is excited; None: its voltage is."""

    def emit(self, drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Excite it about its rest: `experiment.Emit`.

        Parameters
        ----------
        drive : array, shape (samples, 1), V or m
            Deviation from rest.

        Returns
        -------
        emitted : array, shape (samples, 1), V or m
        heard : array, shape (samples, 3 axes), m
            Extension and position of every axis, as the controllers read them, and what a laser sees.
        """


def centre_of(config: StageConfig, loop: Pid | None) -> float:
    """Return the middle of a drive: the rest voltage, V, or where a loop is excited that of its references, m."""
    return config.limits.rest_voltage if loop is None else sum(config.limits.extension) / 2


@dataclass(frozen=True)
class RecordedBench:
    """An axis that is not excited: all is recorded already.

    Parameters
    ----------
    config : StageConfig
    axis : int, counted from 0
    loop : Pid or None
    """

    config: StageConfig
    axis: int
    loop: Pid | None

    def emit(self, drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Refuse, by a RawFolderError.

        Parameters
        ----------
        drive : array, shape (samples, 1), V or m
        """
        return refuse_to_emit(drive)


def left_alone(config: StageConfig) -> StageConfig:
    """Return a rig file with nothing that pushes or moves the simulated stage: no cut is on while it is excited."""
    usual = type(config.simulator)()
    still = {name: getattr(usual, name) for name in _PUSHES}
    return config.model_copy(update={"simulator": config.simulator.model_copy(update=still)})


See = Callable[[np.ndarray, np.ndarray], object]
"""Called now and then with the position (m) and the voltage (V) of each axis, shape (axes,)."""


def unseen(position: np.ndarray, voltage: np.ndarray) -> None:  # noqa: ARG001 (an observer's own arguments)
    """Look at nothing of the position (m) and the voltage (V), shape (axes,), of each axis."""


@dataclass(frozen=True)
class Bench:
    """The stage that the rig file names, with one axis excited and the others at their rest voltage.

    Parameters
    ----------
    config : StageConfig
    axis : int, counted from 0
    loop : Pid or None
        The axis' inner loop, whose reference is excited; None: its voltage is.
    stopped : callable() -> bool
        Asked now and then whether to give up.
    see : callable(array, array)
        Called with position and voltage while the axis is excited; with NaN and the rest voltage when that is over.
    """

    config: StageConfig
    axis: int
    loop: Pid | None
    stopped: Callable[[], bool]
    see: See = unseen

    def emit(self, drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Excite the axis about its rest: `experiment.Emit`.

        Parameters
        ----------
        drive : array, shape (samples, 1), V or m
            Deviation from rest.

        Returns
        -------
        emitted : array, shape (samples, 1), V or m
            What the guard let out, or the reference.
        heard : array, shape (samples, 3 axes), m
            Extension and position of every axis, as the controllers read them, and what a laser sees.

        Raises
        ------
        Stopped : it was asked for.
        ExcitationError : the stage was shut by its guard.
        """
        axes, lead = len(self.config.stage.axes), self._lead
        whole = np.full((lead + len(drive), axes), centre_of(self.config, self.loop))
        whole[lead:, self.axis] += drive[:, 0]
        graph, shut, start, record = self._wired(whole)
        try:
            self._run(graph, shut, lead)
            start()
            self._run(graph, shut, len(drive))
        finally:
            self.see(np.full(axes, np.nan), np.full(axes, self.config.limits.rest_voltage))
        kept = record.recording().data[lead:]
        return kept[:, self.axis : self.axis + 1], kept[:, axes:]

    @property
    def _lead(self) -> int:
        return round(2 * self.config.limits.ramp * self.config.stage.rate)

    def _wired(self, whole: np.ndarray) -> tuple[Graph, Callable[[], str | None], Callable[[], None], Record]:
        """Return the graph, what says why the stage was shut, what starts it, and the record."""
        config, axes = self.config, len(self.config.stage.axes)
        graph = Graph(config.stage.rate)
        shut, start = self._stage(graph)
        unit, drive, let_out = (
            ("V", "guard.request", "guard.voltage")
            if self.loop is None
            else ("m", "controller.extension_reference", "wanted.drive")
        )
        wanted = Recording(config.stage.axes, (unit,) * axes, graph.rate, whole)
        graph.add("wanted", Replay(wanted, {"drive": config.stage.axes}))
        graph.connect("wanted.drive", drive)
        record = Record([Port("drive", unit, axes), *(Port(name, "m", axes) for name in HEARD)], len(whole))
        graph.add("record", record)
        graph.connect(let_out, "record.drive")
        outputs = simulated(left_alone(config))(graph)
        for name in HEARD:
            source, delayed = outputs[name]
            if name in CONTROLLED:
                graph.connect(source, f"sensors.{name}", delayed=delayed)
            graph.connect(source, f"record.{name}", delayed=delayed)
        graph.prepare()
        return graph, shut, start, record

    def _stage(self, graph: Graph) -> tuple[Callable[[], str | None], Callable[[], None]]:
        """Add what checks and guards, and closed loops; return what says why it was shut, and what starts it all."""
        config = self.config
        if self.loop is not None:
            still = Pid(0.0, 0.0, 0.0, self.loop.smoothing, self.loop.tracking)
            loops = [self.loop if axis == self.axis else still for axis in range(len(config.stage.axes))]
            stage = Stage(graph, config, PiezoController(loops, config.limits))
            return lambda: stage.fault, stage.start
        sensors = SensorCheck(config.sensors, len(config.stage.axes))
        guard = VoltageGuard(config.limits, len(config.stage.axes))
        graph.add("sensors", sensors)
        graph.add("guard", guard)
        graph.connect("sensors.fault", "guard.fault")
        return lambda: fault_of(sensors, guard), guard.open

    def _run(self, graph: Graph, shut: Callable[[], str | None], samples: int) -> None:
        end = graph.ticks + samples
        while graph.ticks < end:
            run_offline(graph, min(CHUNK, end - graph.ticks))
            self.see(graph.signal("plant.position")[-1], graph.signal("guard.voltage")[-1])
            if (cause := shut()) is not None:
                raise ExcitationError(
                    f"axis {self.config.stage.axes[self.axis]}: the guard shut the stage: {cause}; "
                    "lower characterisation.excursion or characterisation.scout"
                )
            if self.stopped():
                raise Stopped("stopped")
