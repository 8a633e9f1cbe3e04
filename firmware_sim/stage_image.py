"""The image on the stage's processor and the mechanics it controls: the stage's own graph around the plant."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from calibration.state_space.model import InnovationModel
from ctlblocks.block import Block, Port
from ctlblocks.graph import Graph
from firmware_sim.laboratory import plant_block
from firmware_sim.stage_cut import Cut
from firmware_sim.stage_excitation import Excitation
from firmware_sim.stage_lasers import MISHAPS, StageLasers
from firmware_sim.sticking_stage import StickingStage
from stagectl.config import StageConfig
from stagectl.stage import sensors_kernel
from stagectl.stage.controller import PiezoController
from stagectl.stage.deflection_parameters import deflection_from, is_deflection
from stagectl.stage.inner_parameters import SUFFIX, inner_from
from stagectl.stage.loop import Stage, inner_loops, stage_controller
from stagectl.stage.loop_parameters import loops_from
from stagectl.stage.servo import Servo
from stagectl.stage.state_feedback import StateFeedback
from stagectl.wire import messages, samples
from stagectl.wire.messages import AXES, BLOCK, RATE, Drive, Fault

RATIO = 5.0
"""m of travel per m of extension [Sörnmo 2015, sec. 2.2: a gear ratio of about five]."""
_CREEP = 0.2
"""Hz at which the loops switched on with take creep and hysteresis back: far below any resonance."""
SHORTEST, LONGEST = 5.0, 120.0
"""s, of a cut."""
_LARGEST = samples.largest(messages.POSITION)


class Held(Block):
    """Put out what was set last; zero at first.

    Parameters
    ----------
    name, unit : str, of the output, three wide
    """

    def __init__(self, name: str, unit: str) -> None:
        self.outputs = (Port(name, unit, len(AXES)),)
        self.value = np.zeros(len(AXES))

    def process(self, *signals: np.ndarray) -> None:
        """Fill one frame."""
        signals[0][:] = self.value


class StageImage:
    """What runs on the processor, ten samples a call.

    Switched on, it ramps to rest and closes its loops, with an outer loop that knows nothing of the flexure: the
    reference over the gear ratio, and a slow integral.  Parameters from the host replace them by some that were
    designed.  For identification the loop of one axis can be opened (`excite`) while the others rest.

    Parameters
    ----------
    config : StageConfig
        Three axes; `link.origin` is mid-travel, `simulator.options` are the plant's.
    milling : str
        "x", "y" or "z" for a cut as long as `session.seconds` that begins when a live run is judged; "" for none.

    Raises
    ------
    ValueError : the stage has other axes, or the plant refuses an option.
    """

    def __init__(self, config: StageConfig, milling: str = "") -> None:
        if len(config.stage.axes) != len(AXES) or config.stage.rate != RATE:
            raise ValueError(f"stage.axes has {len(config.stage.axes)} at {config.stage.rate:g} samples/s, "
                             f"must be {len(AXES)} at {RATE}, as on the wire")  # fmt: skip
        self._axes, self._middle = config.stage.axes, config.link.origin
        self._graph = Graph(RATE, 1)
        self._reference = Held("reference", "m")
        plant = plant_block(f"{StickingStage.__module__}:{StickingStage.__name__}", config.simulator.options)
        assert isinstance(plant, StickingStage)
        self._plant = plant
        self._controller = stage_controller(config, [_first_loop()] * len(AXES))
        self._inner = PiezoController(inner_loops(config), config.limits)
        self._extension = Held("extension_reference", "m")
        self._middle_extension = sum(config.limits.extension) / 2
        self._excitation = Excitation(config.limits.rest_voltage)
        self._travel, self._has_left = config.limits.travel, False
        self._stage = Stage(self._graph, config, self._controller, self._excitation)
        self._lasers = StageLasers(config, plant.laser_rate)
        self._cut = _cut(config, milling) if milling else None
        self._wire()
        self._signals = {name: np.zeros((BLOCK, len(AXES))) for name in ("position", "extension", "voltage")}
        self._sources = {
            name: self._graph.signal(source)
            for name, source in (
                ("position", "plant.position"),
                ("extension", "plant.extension"),
                ("voltage", "guard.voltage"),
            )
        }

    @property
    def absolute(self) -> np.ndarray:
        """What a laser on each axis sees: plate and robot together, shape (3,), m; live."""
        frame: np.ndarray = self._graph.signal("plant.absolute")[0]
        return frame

    def tick(self, reference: np.ndarray) -> dict[str, Any]:
        """Run ten samples.

        Parameters
        ----------
        reference : array, shape (10, 3), m from mid-travel; while an axis is excited, V or m from rest

        Returns
        -------
        dict
            "position" (m from mid-travel) and "extension" (m), as the loops read them, and the "voltage" (V) they then
            made, of shape (10, 3); where lasers are read, "absolute" (m from mid-travel) of that shape and their
            account, "laser"; and the "fault".
        """
        guard = self._stage.guard
        if guard.at_rest and not guard.latched:
            self._start()
        position, extension, voltage = self._signals.values()
        for n in range(len(reference)):
            position[n], extension[n] = self._sources["position"][0], self._sources["extension"][0]
            self._follow(reference[n])
            self._graph.tick()
            self._lasers.take(n, guard)
            voltage[n] = self._sources["voltage"][0]
        if self._excitation.drive is not None and guard.is_open:
            self._look_at_travel(position)
        position -= self._middle
        position[~(np.abs(position) <= _LARGEST)] = np.nan  # the sensor's range is wider than the wire's
        return {**self._signals, **self._lasers.signals(self._middle), "fault": self._fault()}

    def commit(self, parameters: Mapping[str, np.ndarray]) -> None:
        """Take other outer loops, other inner loops or both, one an axis, without a step; ValueError refuses them all.

        Parameters
        ----------
        parameters : mapping of str to array, any shape, the units of `StateFeedback` and `Pid`
        """
        inner = {name: value for name, value in parameters.items() if name.endswith(SUFFIX)}
        lasers = {name: value for name, value in parameters.items() if is_deflection(name)}
        outer = {name: value for name, value in parameters.items() if name not in inner and name not in lasers}
        pids = inner_from(self._axes, inner) if inner else []
        loops = loops_from(self._axes, outer, RATE) if outer or not (inner or lasers) else []
        deflection = deflection_from(self._axes, lasers) if lasers else None
        for loop in loops:
            loop.servo.tracking(loop.servo_feedback, RATE)  # what the controller will ask of it
        if outer or lasers:
            self._lasers.change(deflection)
        for axis, pid in enumerate(pids):
            self._controller.change_inner(axis, pid)
            self._inner.change_inner(axis, pid)
        for axis, loop in enumerate(loops):
            self._controller.change_outer(axis, loop)

    def excite(self, drive: Drive, axis: int) -> None:
        """Take all axes to rest, and then let one be driven by what comes; ValueError where it cannot.

        Parameters
        ----------
        drive : Drive
        axis : int, counted from 0
        """
        if not 0 <= axis < len(AXES) or self._stage.fault is not None:
            raise ValueError(f"axis {axis} cannot be excited, must be 0 to {len(AXES) - 1}; fault: {self._stage.fault}")
        self._stage.stop()
        self._excitation.drive, self._excitation.axis = drive, axis

    def release(self) -> None:
        """Take all axes to rest and then close their loops again, where one was excited; a cut is over."""
        if self._cut is not None:
            self._cut.end()
        if self._excitation.drive is not None:
            self._stage.stop()
            self._inner.stop()
            self._excitation.drive = None

    def follow(self) -> None:
        """Watch the lasers and compensate what they see, where parameters say so; the cut begins anew."""
        self._lasers.follow()
        if self._cut is not None:
            self._cut.begin()

    def leave(self) -> None:
        """Compensate no longer, along a ramp."""
        self._lasers.leave()

    def clear(self) -> None:
        """Clear the latch, if there is one; ValueError while the way to rest is not over."""
        if self._stage.fault is not None:
            self._plant.stuck_at = math.nan
            self._has_left = False
            self._lasers.clear()
            self._stage.clear("a person at the host")

    def suffer(self, name: str) -> None:
        """Let the laser on y, or its position sensor, go wrong until the fault is cleared.

        Parameters
        ----------
        name : str, "stuck-sensor" or one of `stage_lasers.MISHAPS`
        """
        if name in MISHAPS:
            self._lasers.suffer(name)
            return
        self._plant.stuck_at = float(self._graph.signal("plant.position")[0, 1])

    def _start(self) -> None:
        if self._excitation.drive is None:
            self._stage.start()
            return
        self._stage.guard.open()
        if self._excitation.drive is Drive.EXTENSION:
            self._inner.start(self._stage.guard.voltage)

    def _follow(self, reference: np.ndarray) -> None:
        """Give the loops their next reference, or the excited axis its next deviation from rest."""
        if self._excitation.drive is None:
            np.add(reference, self._middle, out=self._reference.value)
            return
        deviation = float(reference[self._excitation.axis])
        self._excitation.deviation = deviation
        self._extension.value[:] = self._middle_extension
        self._extension.value[self._excitation.axis] += deviation

    def _look_at_travel(self, position: np.ndarray) -> None:
        low, high = self._travel
        if not (position.min() >= low and position.max() <= high):  # NaN as well
            self._has_left = True
            self._stage.guard.trip(f"the plate left {low:g} to {high:g} m while it was excited")

    def _fault(self) -> Fault:
        if self._stage.fault is None:
            return Fault.NONE
        if self._has_left:
            return Fault.TRAVEL
        if self._lasers.fault is not Fault.NONE:
            return self._lasers.fault
        sensor = self._stage.sensors.fault
        if sensor is None:
            return Fault.CONTROLLER
        return Fault.SENSOR_STUCK if sensor.kind == sensors_kernel.STUCK else Fault.SENSOR_INVALID

    def _wire(self) -> None:
        graph = self._graph
        graph.add("reference", self._reference)
        graph.add("plant", self._plant)
        graph.connect("guard.voltage", "plant.voltage")
        if self._cut is not None:
            graph.add("milling", self._cut)
        for name, unit in (("force", "N"), ("base", "m")):
            if self._cut is None:
                graph.add(name, Held(name, unit))
            graph.connect(f"{name if self._cut is None else 'milling'}.{name}", f"plant.{name}")
        for name in ("position", "extension"):
            graph.connect(f"plant.{name}", f"sensors.{name}", delayed=True)
        graph.connect(self._lasers.wire(graph, "reference.reference"), "controller.reference")
        graph.add("inner", self._inner)
        graph.add("extension", self._extension)
        graph.connect("extension.extension_reference", "inner.extension_reference")
        graph.connect("sensors.valid_extension", "inner.extension")
        graph.connect("inner.request", "compensation.inner")
        graph.prepare()


def _cut(config: StageConfig, direction: str) -> Cut:
    """Return a cut as long as a run, within what a cut can be, that begins when a live run is judged."""
    seconds = min(max(config.session.seconds, SHORTEST), LONGEST)
    return Cut(direction=direction, start=2.5 * config.limits.ramp, seconds=seconds)


def _first_loop() -> StateFeedback:
    """Return the outer loop that a stage is switched on with: l_r and a slow integral, no state feedback."""
    slow = 2 * math.pi * _CREEP
    model = InnovationModel(
        A=np.full((1, 1), 0.5),
        B=np.full((1, 1), 0.5 * RATIO),
        C=np.ones((1, 1)),
        D=np.zeros((1, 1)),
        K=np.zeros((1, 1)),
        rate=RATE,
        innovation=np.ones((1, 1)) * 1e-16,
    )
    servo = Servo(np.ones((1, 1)), np.full((1, 1), 1.0 / RATE), np.array([slow**2]))
    return StateFeedback(model, np.zeros((1, 1)), np.zeros((1, 1)), servo, np.full((1, 1), -slow / RATIO), 1.0 / RATIO)
