"""A rig that is a sine: all that the daemon can show and do, without a machine."""

import math
import threading
import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from rigkit.config import Section, setting
from rigkit.faults import FaultTable
from rigkit.service.not_begun import making
from rigkit.service.reload import Change
from rigkit.service.rig import Desk, Procedure
from rigkit.service.show import Axis, Curves, Gauge, Image, Table, Trace

DRAWN = 100
"""Steps that are drawn: a demonstration may be of very many."""


class Options(Section):
    """What a demonstration may be begun with."""

    steps: int = setting(20, "steps", "steps in all", ge=1, le=100_000)
    seconds: float = setting(0.1, "s", "length of a step", ge=0, le=10)
    breaks_at: int = setting(0, "", "step that fails; 0 for none", ge=0)
    model: str = setting("", "", "what it needs, which is not there; empty for nothing")


class DemoRig:
    """Its output is 1 during a step, and 0 otherwise."""

    program, name = "demo", "bench"

    def __init__(self, faults: bool = False) -> None:
        self.faults = FaultTable(("travel", "force")) if faults else None
        self.output, self.armed, self.acknowledged_by = 0.0, False, ""
        self.stops = 0
        self.refuses_to_arm = ""
        self.change = Change({})
        self.edited = ""
        self._stop = threading.Event()

    @property
    def procedures(self) -> Sequence[Procedure]:
        words: Any = {"unit": "steps", "options": Options, "run": self._run}
        paused, aborted = "it pauses after this step", "it ends after this step"
        return (
            Procedure("demonstrate", "Demonstration", "run", pausable=True, on_pause=paused, on_abort=aborted, **words),
            Procedure("measure", "Measurement", "calibrate", pausable=False, on_pause="", on_abort=aborted, **words),
        )

    def gauges(self) -> Sequence[Gauge]:
        wave = math.sin(time.monotonic())
        return (
            Gauge("output", "Output", self.output, "V", high=2.0, is_output=True),
            Gauge("travel", "Travel", 1e-6 * wave, "m", low=-1.05e-6, high=1.05e-6),
            Gauge("force", "Force", 10 + wave, "N", interval=(9 + wave, 11 + wave)),
            Gauge("temperature", "Temperature", None, "K"),
        )

    def arm(self) -> None:
        if self.refuses_to_arm:
            raise ValueError(self.refuses_to_arm)
        self.armed = True

    def disarm(self) -> None:
        self.armed = False

    def stop(self) -> None:
        self.stops += 1
        self.output = 0.0
        self._stop.set()

    def acknowledge(self, who: str) -> None:
        self.acknowledged_by = who

    def settings(self) -> str:
        return 'name = "bench"\n'

    def edits(self) -> str:
        return self.edited

    def reload(self) -> Change:
        return self.change

    def close(self) -> None:
        self.armed = False

    def _run(self, desk: Desk, options: Options) -> None:
        with making(desk):
            if options.model:
                desk.show("lines", Table("Of a procedure that may not begin", ("nothing",), ()))
                raise ValueError(f"model is {options.model!r}, must be nothing")
        desk.recording(True)
        errors: list[float] = []
        for step in range(options.steps):
            if desk.held():
                desk.recording(False)
                desk.wait_while_held()
                desk.recording(True)
            if desk.ending():
                break
            self._stop.clear()
            self.output = 1.0
            if desk.ending():  # a STOP may have come before the step had begun
                self.output = 0.0
            self._stop.wait(options.seconds)
            self.output = 0.0
            if step + 1 == options.breaks_at:
                raise OSError("the bench has broken")
            errors.append(0.8**step)
            desk.progress(step + 1, options.steps, f"error {errors[-1]:.3g}")
            desk.event("step", {"step": step, "error": errors[-1]})
            self._draw(desk, errors[-DRAWN:])
        desk.recording(False)

    def _draw(self, desk: Desk, errors: list[float]) -> None:
        steps, error = np.arange(len(errors)), Axis("error", "1", "log")
        limit = Trace("limit", np.array([0.0, 20.0]), np.array([0.01, 0.01]), "limit")
        curve = Trace("error", steps, np.array(errors), low=0.9 * np.array(errors), high=1.1 * np.array(errors))
        desk.show("convergence", Curves("Convergence", Axis("step", "1"), error, (curve, limit)))
        draw = np.random.default_rng(len(errors))
        travel, bins = Axis("error", "m"), np.arange(-20, 21) * 1e-9
        counts = np.histogram(draw.normal(0, 5e-9, 4000), np.append(bins, 21e-9) - 0.5e-9)[0]
        bars = Trace("axis 1", bins, counts.astype(float))
        desk.show("histogram", Curves("Error", travel, Axis("samples", "1"), (bars,), "bars"))
        angle = np.linspace(0, 6.3, 200)
        points = Trace("joint 1", 1e-3 * np.sin(angle), 20 * np.sin(angle - 0.5) + draw.normal(0, 0.5, 200))
        map_axes = Axis("joint angle", "rad"), Axis("motor torque", "N m")
        desk.show("map", Curves("Torque over position", *map_axes, (points,), "points"))
        rows = (("1", 120.0, -2.5), ("2", 180.5, None))
        desk.show("lines", Table("Worst lines", ("side", "frequency, Hz", "over the limit, dB"), rows))
        plane = draw.normal(-60, 3, (40, 60))
        axes = Axis("time", "s"), Axis("frequency", "Hz"), Axis("level", "dB")
        desk.show("spectrogram", Image("Spectrogram", *axes, (0.0, 5.9), (0.0, 650.0), (-80.0, 0.0), plane))


def anew(load: object) -> DemoRig:  # noqa: ARG001 (as any rig is made)
    """Return one as a command line makes it."""
    return DemoRig()
