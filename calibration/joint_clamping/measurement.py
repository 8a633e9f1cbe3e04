"""The clamping procedure run on a robot block: what each joint showed while it was moved to and fro, saved raw."""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor, Future
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from calibration.joint_clamping.maps_page import draw_map
from calibration.joint_clamping.requests import Requests
from calibration.joint_clamping.samples import Samples
from ctlblocks import Block, Graph, recording
from ctlblocks.room import bytes_of
from rigkit.disk_space import require
from rigkit.stop import Stopped
from stagectl.robot.clamp_search import ClampSearch
from stagectl.wire.egm import RATE

SEEN = {"angle": "rad", "torque": "N m", "link": "rad", "pose": "1", "frames": "1"}
"""What is kept of the robot's outputs, and their units; the last three only where it has them."""
APPROACH = "approach.wav"
"""The way to the clamp: from it the axes are found about which the tracked links turn."""

A_JOINT = 600.0
"""s of a joint's record, as a rule at most: the search for its limits, and its cycles."""
CHANNELS = 32
"""Of it, at most."""

Tell = Callable[[str], None]


def unwatched(run: "ClampRun") -> None:  # noqa: ARG001 (an observer's own argument)
    """Look at nothing."""


class ClampAborted(ValueError):
    """The procedure was aborted; the text says why, and where the arm stands."""


def recording_name(joint: int) -> str:
    """Return how the recording of a joint, from 0, is called."""
    return f"joint-{joint + 1}.wav"


class ClampRun:
    """A robot block under the procedure, in a graph that somebody ticks, and what is kept of it.

    Parameters
    ----------
    robot : Block
        With the ports of `ClampSearch`, the other way round.
    search : ClampSearch
    rate : float, samples/s
    folder : Path
        Gets `joint-1.wav` ..., the way to the clamp, and the maps as they grow.
    tell : callable(str)
        Told each step in words as it begins, each pause and each cycle.
    asked : Requests
    work : Executor
        Writes and draws; what would make the clock wait is done elsewhere.
    every_cycle : bool
        Whether maps are drawn as each cycle ends; else as each joint does.
    watch : callable(ClampRun)
        Called after every tick.
    """

    def __init__(
        self, robot: Block, search: ClampSearch, rate: float, folder: Path, tell: Tell, asked: Requests,
        work: Executor, every_cycle: bool, watch: Callable[["ClampRun"], object],
    ) -> None:  # fmt: skip
        self.graph, self.search = _graph(robot, search, rate), search
        self._folder, self._tell, self._asked, self._work = folder, tell, asked, work
        self._every_cycle, self._watch = every_cycle, watch
        seen = {port.name for port in robot.outputs} & set(SEEN)
        self._samples = Samples({name: self.graph.signal(f"robot.{name}") for name in SEEN if name in seen}, SEEN)
        self._joint, self._reference = self.graph.signal("search.joint"), self.graph.signal("search.reference")
        self._before, self._cycles, self._step, self._paused = -1, 0, -1, False
        self._last_reference = self._reference.copy()
        self._written: list[Future[Any]] = []
        self._drawn: Future[Any] | None = None

    def look(self) -> bool:
        """Keep what the last tick showed, do as a person asks; return whether the run is over.

        After a torque too large it is over once the references are back where there was little.
        """
        if self.graph.ticks == 0:
            return False
        self._watch(self)
        if self.search.cause is not None:
            rests = bool((self._reference == self._last_reference).all())
            self._last_reference[:] = self._reference
            return rests
        self._last_reference[:] = self._reference
        self._ask()
        self._keep()
        self._say()
        return self.search.done or self._asked.stop

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
        angle, torque = self._map(joint)
        return joint, cycles, angle, torque

    def finish(self) -> None:
        """Wait for the files, and say how it ended.

        Raises
        ------
        ClampAborted : something went wrong; what was recorded is kept.
        Stopped : it was asked to.
        """
        for each in self._written:
            each.result()
        if self.search.cause is not None:
            raise ClampAborted(f"{self.search.cause}; {self.where}")
        if not self.search.done:
            self.search.abort("stopped by a person")
            raise Stopped(f"stopped in step {self.search.step + 1}: the arm holds; joints that were done are kept")

    @property
    def where(self) -> str:
        """Where the arm stands after an abort, in words."""
        return f"the arm holds in step {self.search.step + 1}, soft servo and clamp stay"

    def _ask(self) -> None:
        if self._asked.pause != self._paused:
            self._paused = self._asked.pause
            if self._paused:
                self.search.pause()
            else:
                self.search.resume()
            self._tell(f"{self._time()}  {'paused: the arm holds' if self._paused else 'goes on'}")

    def _keep(self) -> None:
        now = int(self._joint[0, 0]) - 1
        approaches = self.search.step == 0
        if self._before >= 0 and now != self._before:
            self._end_joint()
        elif not approaches and self._before < 0 and len(self._samples):
            self._write(APPROACH)
        if now >= 0 or approaches:
            self._samples.keep()
        if now >= 0 and self.search.cycles > self._cycles:
            self._cycles = self.search.cycles
            if self._every_cycle and (self._drawn is None or self._drawn.done()):
                self._draw(now)
        self._before = now

    def _end_joint(self) -> None:
        self._draw(self._before)
        self._write(recording_name(self._before))
        self._cycles = 0

    def _write(self, name: str) -> None:
        made = self._samples.recording(self.graph.rate)
        self._written.append(self._work.submit(recording.write, self._folder / name, made))
        self._samples.clear()

    def _draw(self, joint: int) -> None:
        angle, torque = self._map(joint)
        self._drawn = self._work.submit(partial(draw_map, self._folder, joint, angle, torque, self._cycles))
        self._written.append(self._drawn)

    def _map(self, joint: int) -> tuple[np.ndarray, np.ndarray]:
        made = self._samples.recording(self.graph.rate)
        angle, torque = made.select([f"angle_{joint + 1}", f"torque_{joint + 1}"]).data.T
        return angle, torque

    def _say(self) -> None:
        if self.search.step != self._step and not self.search.done:
            for each in self.search.steps[self._step + 1 : self.search.step + 1]:
                self._tell(f"{self._time()}  {each.words}")
            self._step = self.search.step

    def _time(self) -> str:
        return f"{self.graph.ticks / self.graph.rate:7.1f} s"


def _graph(robot: Block, search: ClampSearch, rate: float) -> Graph:
    graph = Graph(rate)
    graph.add("robot", robot)
    graph.add("search", search)
    for port in search.inputs:
        graph.connect(f"robot.{port.name}", f"search.{port.name}")
    for name in ("reference", "soft", "clamp"):
        graph.connect(f"search.{name}", f"robot.{name}", delayed=True)
    graph.prepare()
    return graph


def require_room(folder: Path, joints: int) -> None:
    """Refuse, by a `DiskFault`, to begin on so many joints where the disk has no room for them.

    Parameters
    ----------
    folder : Path
    joints : int
    """
    needed = joints * bytes_of(round(A_JOINT * RATE), CHANNELS, "float32", "wav")
    require(folder, needed, f"{joints} joints")


def missing(folder: Path, joints: Sequence[int]) -> tuple[int, ...]:
    """Return the joints, from 0, that have no recording in a folder yet."""
    return tuple(joint for joint in joints if not (folder / recording_name(joint)).exists())
