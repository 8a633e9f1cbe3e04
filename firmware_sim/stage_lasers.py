"""The lasers of the simulated stage and what its processor makes of them: checked readings, and a reference."""

import numpy as np

from ctlblocks.block import Block, Port
from ctlblocks.graph import Graph
from stagectl.config import StageConfig
from stagectl.stage import laser_check_kernel as kernel
from stagectl.stage.deflection_parameters import DeflectionLoop
from stagectl.stage.guard import VoltageGuard
from stagectl.stage.laser_check import LaserCheck, LaserLimits
from stagectl.stage.laser_deflection import LaserDeflection
from stagectl.stage.prefiltered_reference import PrefilteredReference
from stagectl.wire import messages, samples
from stagectl.wire.messages import AXES, BLOCK, Fault

MISHAPS = ("stuck-laser", "late-laser", "jumping-laser", "silent-laser")
LATE, JUMP, SICK = 5e-3, 1e-3, 1
"""s by which a laser lags, m by which it jumps, and which axis' laser does, counted from 0."""
_REPORTED = 100
"""Blocks from one account to the next."""
_LARGEST = samples.largest(messages.ABSOLUTE)
_FAULTS = {
    kernel.STALE: Fault.LASER_STALE,
    kernel.STUCK: Fault.LASER_STUCK,
    kernel.RANGE: Fault.LASER_IMPOSSIBLE,
    kernel.JUMP: Fault.LASER_IMPOSSIBLE,
}


class Lasers(Block):
    """Give each laser's newest reading with its age, as the processor gets them: it triggers the cycles, and counts.

    Ports, one wide an axis: `absolute` (m, as the plant shows it) in; `reading` (m), `age` (s) out.

    Parameters
    ----------
    cycles : float, readings/s, those of the plant
    """

    inputs = (Port("absolute", "m", len(AXES)),)
    outputs = (Port("reading", "m", len(AXES)), Port("age", "s", len(AXES)))

    def __init__(self, cycles: float) -> None:
        self.mishap = ""
        self._cycles = cycles

    def prepare(self, rate: float, frames: int) -> None:
        """Begin with the first cycle."""
        self.mishap = ""
        self._step, self._phase, self._since, self._age = self._cycles / rate, 0.0, 0.0, 0.0
        self._period, self._frozen = 1.0 / rate, np.nan
        self._line = np.zeros((round(LATE * rate) + 1, 2))
        self._at = 0

    def process(self, absolute: np.ndarray, reading: np.ndarray, age: np.ndarray) -> None:
        """Show one frame."""
        for n in range(len(absolute)):
            self._phase += self._step
            self._since += self._period
            self._age += self._period
            if self._phase >= 1.0:
                self._phase -= 1.0
                self._age, self._since = self._since, 0.0  # what is shown was seen a cycle ago
            reading[n], age[n] = absolute[n], self._age
            self._line[self._at] = absolute[n, SICK], self._age
            self._at = (self._at + 1) % len(self._line)
            if self.mishap:
                reading[n, SICK], age[n, SICK] = self._sick(reading[n, SICK], age[n, SICK])

    def _sick(self, reading: float, age: float) -> tuple[float, float]:
        if np.isnan(self._frozen):
            self._frozen, self._silent = reading, age
        self._silent += self._period
        match self.mishap:
            case "stuck-laser":
                return self._frozen, age
            case "silent-laser":
                return self._frozen, self._silent
            case "late-laser":
                late, its_age = self._line[self._at]
                return late, its_age + LATE
        return reading + JUMP, age

    def recover(self) -> None:
        """Be in order again (between ticks)."""
        self.mishap, self._frozen = "", np.nan


class StageLasers:
    """Lasers, their check, the deflection loop and its prefilters, in the graph of the processor's image.

    Parameters
    ----------
    config : StageConfig
    cycles : float, readings/s, of the simulated lasers
    """

    def __init__(self, config: StageConfig, cycles: float) -> None:
        laser = config.laser
        self.is_on, self._compensates, self._follows, self._is_spent = False, False, False, False
        self.fault, self._has_news, self._blocks = Fault.NONE, False, 0
        self._lasers = Lasers(cycles)
        limits = LaserLimits(laser.rate, laser.late, laser.stuck, laser.speed)
        self._check = LaserCheck(limits, config.link.origin, _LARGEST, len(AXES))
        self._deflection = LaserDeflection(config.deflection.corner, config.limits.ramp, len(AXES))
        self._prefilter = PrefilteredReference([None] * len(AXES))
        self._absolute = np.zeros((BLOCK, len(AXES)))

    def wire(self, graph: Graph, reference: str) -> str:
        """Add the blocks behind the plant and an output of references; return the output to follow."""
        graph.add("lasers", self._lasers)
        graph.add("laser_check", self._check)
        graph.add("deflection", self._deflection)
        graph.add("prefilter", self._prefilter)
        graph.connect("plant.absolute", "lasers.absolute")
        for name in ("reading", "age"):
            graph.connect(f"lasers.{name}", f"laser_check.{name}", delayed=True)
        graph.connect(reference, "deflection.wanted")
        graph.connect("laser_check.valid", "deflection.laser")
        graph.connect("laser_check.valid_age", "deflection.age")
        graph.connect("plant.position", "deflection.position", delayed=True)
        graph.connect("deflection.reference", "prefilter.reference")
        self._seen = graph
        return "prefilter.filtered"

    def change(self, loop: DeflectionLoop | None) -> None:
        """Take other limits, corner and prefilters for the next run (between ticks); None switches lasers off."""
        self._is_spent = False
        self.is_on = loop is not None
        self._compensates = loop is not None and loop.corner is not None
        filters = list(loop.prefilters) if loop is not None else []
        self._prefilter.change(filters or [None] * len(AXES))
        if loop is not None:
            self._check.change(loop.limits)
            self._deflection.change(self._deflection.corner if loop.corner is None else loop.corner)

    def follow(self) -> None:
        """Watch the lasers, and compensate what they see (between ticks): once for each `change`."""
        if self._is_spent:
            self.change(None)
        self._check.clear()
        self._follows = self.is_on
        if self._compensates:
            self._deflection.fade_in()

    def leave(self) -> None:
        """Watch them no longer, and cease to compensate along a ramp (between ticks)."""
        self._follows, self._is_spent = False, True
        self._deflection.fade_out()

    def suffer(self, name: str) -> None:
        """Let the laser on y go wrong (between ticks), one of `MISHAPS`."""
        self._lasers.mishap = name

    def clear(self) -> None:
        """Forget the fault; the laser is in order again (between ticks)."""
        self.fault = Fault.NONE
        self._lasers.recover()
        self._check.clear()

    def take(self, n: int, guard: VoltageGuard) -> None:
        """Keep what they show in sample `n` of a block, and latch the guard on a fault."""
        self._absolute[n] = self._seen.signal("laser_check.valid")[0]
        if self._follows and self.fault is Fault.NONE and (found := self._check.fault) is not None:
            self.fault, self._has_news = _FAULTS[found.kind], True
            guard.trip(str(found))

    def signals(self, middle: float) -> dict[str, object]:
        """Return what is shown of a block while they are on: "absolute", and now and then their account, "laser"."""
        if not self.is_on:
            return {}
        shown = self._absolute - middle
        shown[~(np.abs(shown) <= _LARGEST)] = np.nan
        self._blocks += 1
        if self._blocks % _REPORTED and not self._has_news:
            return {"absolute": shown}
        self._has_news = False
        return {"absolute": shown, "laser": self._account()}

    def _account(self) -> tuple[int, ...]:
        found = self._check.fault if self.fault is not Fault.NONE else None
        age = min(round(1e4 * self._check.greatest_age()), 0xFFFF)
        return age, min(self._check.held, 0xFFFF), 0 if found is None else found.axis + 1, 0
