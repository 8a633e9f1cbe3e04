"""The stage's controllers as blocks: every axis' two loops in one compiled kernel, or its inner loop alone."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.config import Limits
from stagectl.stage import controller_kernel as kernel
from stagectl.stage.axis_record import AXIS, CHANGE, CHANGE_MODEL, IDLE, MEMORY, RUNNING, START
from stagectl.stage.piezo_pid import Pid
from stagectl.stage.state_feedback import StateFeedback


@dataclass(frozen=True)
class Met:
    """In how many samples a limit was met, a number an axis.

    Parameters
    ----------
    reference, extension, voltage : tuple of int, samples
        Beyond the travel; extension references and voltages beyond range or rate of change.
    """

    reference: tuple[int, ...]
    extension: tuple[int, ...]
    voltage: tuple[int, ...]


class _Axes:
    """What both controllers have: a record an axis, limits, and a start from where the stage stands."""

    def __init__(self, inner: Sequence[Pid], limits: Limits) -> None:
        if not inner:
            raise ValueError("there is no axis, must be at least one")
        self._inner, self._limits = list(inner), limits
        self._axes = np.zeros(len(inner), AXIS)
        self._axes["rising"] = 1

    def prepare(self, rate: float, frames: int) -> None:
        """Be idle at the rest voltage."""
        axes, limits = self._axes, self._limits
        axes["phase"], axes["command"], axes["rising"], axes["ramp_at"] = IDLE, START, 1, 0
        for name in MEMORY:
            axes[name] = 0
        axes["voltage"] = limits.rest_voltage
        axes["ramp"] = max(1, round(limits.ramp * rate))
        axes["rest"] = limits.rest_position
        axes["reference_low"], axes["reference_high"] = limits.travel
        axes["extension_low"], axes["extension_high"] = limits.extension
        axes["voltage_low"], axes["voltage_high"] = limits.voltage
        axes["extension_step"], axes["voltage_step"] = limits.extension_slew / rate, limits.voltage_slew / rate
        for axis, settings in enumerate(self._inner):
            _set(axes[axis], settings.coefficients(rate))
        self._rate = rate

    def start(self, voltage: np.ndarray) -> None:
        """Begin to control (between ticks), from where the stage is.

        The first request is `voltage`, the first reference is where the sensors are; the way from there to the
        reference takes `limits.ramp`.

        Parameters
        ----------
        voltage : array, shape (axes,), V
            As it is now.
        """
        self._axes["voltage"] = voltage
        self._axes["command"], self._axes["phase"], self._axes["rising"] = START, RUNNING, 1

    def stop(self) -> None:
        """Become idle (between ticks): requests stay as they are."""
        self._axes["phase"] = IDLE

    def change_inner(self, axis: int, settings: Pid) -> None:
        """Take another PID on an axis (between ticks), without a step in its voltage."""
        self._inner[axis] = settings
        _set(self._axes[axis], settings.coefficients(self._rate))
        self._command(axis, CHANGE)

    @property
    def met(self) -> Met:
        """How often limits were met since `prepare`."""
        axes = self._axes
        return Met(*(tuple(axes[f"{name}_limited"].tolist()) for name in ("reference", "extension", "voltage")))

    def _command(self, axis: int, command: int) -> None:
        """Let the next sample begin so, unless it begins with more already."""
        waiting = int(self._axes["command"][axis])
        self._axes["command"][axis] = waiting if waiting == START else max(waiting, command)


class StageController(_Axes, Block):
    """Position control of every axis: LQG with servo states gives the extension's reference, a PID the voltage.

    Idle after `prepare`; `start`, `hold`, `follow` and the changes of parameters are for between ticks
    (`Graph.changes`) and make no step in any voltage.

    Ports, one wide an axis: `reference`, `position`, `extension` (m) in; `request` (V), `extension_reference` (m) out.

    Parameters
    ----------
    inner : sequence of Pid, one an axis
    outer : sequence of StateFeedback, one an axis
    limits : Limits

    Raises
    ------
    ValueError : there is no axis, or not one of each kind for each.
    """

    def __init__(self, inner: Sequence[Pid], outer: Sequence[StateFeedback], limits: Limits) -> None:
        super().__init__(inner, limits)
        if len(outer) != len(inner):
            raise ValueError(f"there are {len(inner)} inner and {len(outer)} outer loops, must be one of each an axis")
        axes = len(inner)
        self.inputs = (Port("reference", "m", axes), Port("position", "m", axes), Port("extension", "m", axes))
        self.outputs = (Port("request", "V", axes), Port("extension_reference", "m", axes))
        self._outer = list(outer)

    def prepare(self, rate: float, frames: int) -> None:
        """Be idle; refuse a loop that was designed for another rate."""
        super().prepare(rate, frames)
        for axis, loop in enumerate(self._outer):
            if loop.model.rate != rate:
                raise ValueError(f"axis {axis + 1}: the model has {loop.model.rate:g} samples/s, must be {rate:g}")
            _set_outer(self._axes[axis], loop)

    def process(
        self,
        reference: np.ndarray,
        position: np.ndarray,
        extension: np.ndarray,
        request: np.ndarray,
        extension_reference: np.ndarray,
    ) -> None:
        """Control one frame."""
        kernel.run(reference, position, extension, request, extension_reference, self._axes)

    def hold(self) -> None:
        """Go to the rest position, controlled, and stay there whatever the reference is (between ticks)."""
        self._axes["rising"] = 0

    def follow(self) -> None:
        """Go back to following the reference (between ticks)."""
        self._axes["rising"] = 1

    def change_outer(self, axis: int, loop: StateFeedback) -> None:
        """Take another outer loop on an axis (between ticks).

        The filter goes on where the model is the same, and else begins at rest where the axis stands; the integral
        is set so that the extension's reference makes no step.

        Parameters
        ----------
        axis : int, counted from 0
        loop : StateFeedback
        """
        if loop.model.rate != self._rate:
            raise ValueError(f"the model has {loop.model.rate:g} samples/s, must be {self._rate:g}")
        before = self._outer[axis]
        same = loop.model is before.model and len(loop.servo.A) == len(before.servo.A)
        self._outer[axis] = loop
        _set_outer(self._axes[axis], loop)
        self._command(axis, CHANGE if same else CHANGE_MODEL)


class PiezoController(_Axes, Block):
    """The inner loops alone: a PID an axis makes the extension follow its reference; to identify what is outside.

    Ports, one wide an axis: `extension_reference`, `extension` (m) in; `request` (V) out.

    Parameters
    ----------
    inner : sequence of Pid, one an axis
    limits : Limits
    """

    def __init__(self, inner: Sequence[Pid], limits: Limits) -> None:
        super().__init__(inner, limits)
        self.inputs = (Port("extension_reference", "m", len(inner)), Port("extension", "m", len(inner)))
        self.outputs = (Port("request", "V", len(inner)),)

    def process(self, extension_reference: np.ndarray, extension: np.ndarray, request: np.ndarray) -> None:
        """Control one frame."""
        kernel.run_inner(extension_reference, extension, request, self._axes)


def _set(record: np.void, values: dict[str, float]) -> None:
    for name, value in values.items():
        record[name] = value


def _set_outer(record: np.void, loop: StateFeedback) -> None:
    n, m = loop.model.order, len(loop.servo.A)
    record["states"], record["servo_states"], record["forward"] = n, m, loop.forward
    record["observer"][:n, :n] = loop.observer
    record["drive"][:n] = loop.drive[:, 0]
    record["correction"][:n] = loop.gain[:, 0]
    record["feedback"][:n] = loop.feedback[0]
    record["servo"][:m, :m] = loop.servo.A
    record["servo_error"][:m] = loop.servo.B[:, 0]
    record["servo_tracking"][:m] = loop.servo.tracking(loop.servo_feedback, loop.model.rate)[:, 0]
    record["servo_feedback"][:m] = loop.servo_feedback[0]
