"""The clamping procedure on a robot block as a part of an experiment, told of and drawn as it goes."""

import sys
from collections.abc import Callable
from concurrent.futures import Executor, Future
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from calibration.joint_clamping.maps_page import draw_map
from calibration.joint_clamping.recorded_joints import SEEN
from calibration.joint_clamping.samples import Samples
from ctlblocks import Block, Graph
from ctlblocks.taps import Tap
from rigkit.experiment.part import Part, Phase, Retreat, Track
from stagectl.robot.clamp_search import ClampSearch
from stagectl.wire.robot import RATE

WATCHED = ("softened", "clamped", "fault")
"""What is recorded of the robot beside `SEEN`: with angle and torque all that the procedure goes by."""
MADE = ("reference", "soft", "clamp", "joint")
"""What the procedure asks for."""
BACK = 60.0
"""s in which references are back where there was little torque, at most."""
MAPPED = {"angle": "rad", "torque": "N m"}

Tell = Callable[[str], None]


class GrowingMaps:
    """Torque-position maps drawn into a folder as they grow.

    Parameters
    ----------
    folder : Path
    work : Executor
        Draws: what would make the clock wait is done elsewhere.
    every_cycle : bool
        Whether one is drawn as each cycle ends; else as each joint does.
    """

    def __init__(self, folder: Path, work: Executor, every_cycle: bool) -> None:
        self.every_cycle = every_cycle
        self._folder, self._work = folder, work
        self._drawn: list[Future[Any]] = []

    @property
    def is_idle(self) -> bool:
        """Whether all that was asked for is drawn."""
        return all(each.done() for each in self._drawn)

    def draw(self, joint: int, angle: np.ndarray, torque: np.ndarray, cycles: int) -> None:
        """Draw a joint's map anew: shape (samples,) each, rad and N m."""
        self._drawn = [each for each in self._drawn if not each.done() or each.result()]
        self._drawn.append(self._work.submit(partial(draw_map, self._folder, joint, angle, torque, cycles)))

    def finish(self) -> None:
        """Wait for what is being drawn."""
        for each in self._drawn:
            each.result()


class ClampRun:
    """The procedure on a robot block, from its first tick to where the arm holds.

    Parameters
    ----------
    name : str
        Of the part, and of its recording.
    search : ClampSearch
    tell : callable(str)
        Told each step in words as it begins, each pause and each cycle.
    pauses : callable() -> bool
        Whether it is to stay where it is; asked in every tick.
    maps : GrowingMaps
    """

    def __init__(
        self, name: str, search: ClampSearch, tell: Tell, pauses: Callable[[], bool], maps: GrowingMaps
    ) -> None:
        self.name, self.search, self.graph, self.tell = name, search, Graph(RATE), tell
        self._pauses, self._maps = pauses, maps
        self._before, self._cycles, self._step = -1, 0, -1
        self._is_paused = self._is_stopped = False
        self._last_reference: np.ndarray | None = None

    def part(self, robot: Block) -> Part:
        """Return it on a robot: a block with the ports of `ClampSearch`, the other way round."""
        graph = self.graph
        graph.add("robot", robot)
        graph.add("search", self.search)
        for port in self.search.inputs:
            graph.connect(f"robot.{port.name}", f"search.{port.name}")
        for name in ("reference", "soft", "clamp"):
            graph.connect(f"search.{name}", f"robot.{name}", delayed=True)
        seen = [port.name for port in robot.outputs if port.name in (*SEEN, *WATCHED)]
        taps = (*(Tap(name, f"robot.{name}") for name in seen), *(Tap(name, f"search.{name}") for name in MADE))
        phase = Phase("procedure", sys.maxsize, self._begin, every=1, look=self._look)
        retreat = Retreat(self._fault, self._hold, round(BACK * RATE), every=1, look=self._rests)
        return Part(self.name, graph, (Track(self.name, taps, frozenset(MADE)),), (phase,), retreat=retreat)

    def growing(self) -> tuple[int, int, np.ndarray, np.ndarray] | None:
        """Return what is known of the joint that is moved now, from any thread; None where none is.

        Returns
        -------
        joint, cycles : int
            From 0; those that are done.
        angle, torque : arrays, shape (samples,), rad and N m
        """
        joint, cycles = self._before, self._cycles
        if joint < 0 or not len(self._samples):
            return None
        return joint, cycles, *self._map(joint)

    @property
    def where(self) -> str:
        """In which step it is, in words."""
        return f"step {self.search.step + 1}"

    def _begin(self) -> None:
        self._samples = Samples({name: self.graph.signal(f"robot.{name}") for name in MAPPED}, MAPPED)
        self._joint = self.graph.signal("search.joint")
        self._say()

    def _look(self) -> bool:
        """Keep what the last tick showed, do as a person asks; return whether all steps are done."""
        if self.search.cause is not None:
            return False
        self._ask()
        self._keep()
        self._say()
        return self.search.done

    def _fault(self) -> str:
        cause = self.search.cause
        return "" if cause is None or self._is_stopped else cause

    def _hold(self, reason: str) -> None:
        self._is_stopped = self.search.cause is None
        self.search.abort(reason)

    def _rests(self) -> bool:
        """Whether references stand still: after a torque too large they go back to where there was little."""
        reference, last = self.graph.signal("search.reference").copy(), self._last_reference
        self._last_reference = reference
        return last is not None and bool((reference == last).all())

    def _ask(self) -> None:
        if self._pauses() == self._is_paused:
            return
        self._is_paused = not self._is_paused
        if self._is_paused:
            self.search.pause()
        else:
            self.search.resume()
        self.tell(f"{self._time()}  {'paused: the arm holds' if self._is_paused else 'goes on'}")

    def _keep(self) -> None:
        now = int(self._joint[0, 0]) - 1
        if self._before >= 0 and now != self._before:
            self._maps.draw(self._before, *self._map(self._before), self._cycles)
            self._samples.clear()
            self._cycles = 0
        if now >= 0:
            self._samples.keep()
            if self.search.cycles > self._cycles:
                self._cycles = self.search.cycles
                if self._maps.every_cycle and self._maps.is_idle:
                    self._maps.draw(now, *self._map(now), self._cycles)
        self._before = now

    def _map(self, joint: int) -> tuple[np.ndarray, np.ndarray]:
        made = self._samples.recording(self.graph.rate)
        angle, torque = made.select([f"angle_{joint + 1}", f"torque_{joint + 1}"]).data.T
        return angle, torque

    def _say(self) -> None:
        if self.search.step != self._step and not self.search.done:
            for each in self.search.steps[self._step + 1 : self.search.step + 1]:
                self.tell(f"{self._time()}  {each.words}")
            self._step = self.search.step

    def _time(self) -> str:
        return f"{self.graph.ticks / self.graph.rate:7.1f} s"
