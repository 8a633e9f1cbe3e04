"""All wires of a live trial: the robot's port, its torque signals, tracker and force sensor, opened together."""

import time
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from typing import Any, Self

import numpy as np

from rigkit.experiment.part import nothing
from stagectl.link.tell import Tell
from stagectl.robot.beside import await_torques, program_of, torques_of
from stagectl.robot.config import CellConfig
from stagectl.robot.force_stream import ForceStream
from stagectl.robot.live.force_records import ForceRecords
from stagectl.robot.live.tracker_samples import TrackerSamples
from stagectl.robot.port import RobotPort
from stagectl.robot.program import Torques, begin_motion
from stagectl.wire.robot import RATE

LISTEN = 250
"""Reports that are listened to before a trial: by the quickest of them, and of the tracker's samples, clocks are told
apart."""
_APART = 3
"""Reports in a row that came when they were due."""


class LiveWires:
    """The robot's other end: a context manager that opens its wires by `begin`, and holds the robot when it is left.

    Parameters
    ----------
    cell : CellConfig
        Its limits are looked at last, on what goes out, whatever a graph has looked at before.
    tell : callable(event, fields)
        Told of the port's faults.
    tracks : bool
        Whether tracker and torque signals are listened to as well.
    now : callable() -> float, s, a monotonic clock
    feels : bool
        Whether force sensor and torque signals are listened to as well.
    beside : callable()
        Called just before the robot may be led: what else is behind wires begins.
    """

    def __init__(
        self,
        cell: CellConfig,
        tell: Tell,
        tracks: bool = True,
        now: Callable[[], float] = time.monotonic,
        feels: bool = True,
        beside: Callable[[], object] = nothing,
    ) -> None:
        robot = cell.robot.model_copy(update={"mode": "joints"})
        self.cell, self._now = cell.model_copy(update={"robot": robot}), now
        self.port = RobotPort(self.cell, tell, now)
        self.records = ForceRecords(cell.force_sensor)
        self.tracker = TrackerSamples(cell.tracker, now, robot.patience) if tracks else None
        self.signals: Torques | None = None
        self._feels, self._beside = feels, beside
        self.first, self.begun, self.tracker_late, self.torque_late = 0, 0.0, 0.0, 0.0
        self._stack = ExitStack()

    def __enter__(self) -> Self:
        """Open nothing yet: what has to be made before a trial is made while nobody leads the robot."""
        return self

    def __exit__(self, *_: object) -> None:
        """Hold the robot, and close all."""
        self._stack.close()

    def begin(self) -> None:
        """Open all, have guided motion begun anew where it has ended, and let the robot be led from where it is.

        The next report is a trial's first.

        Raises
        ------
        LinkError : a wire that cannot be had; the robot is silent, its motors are off, or it is not in guided motion.
        """
        self._open()
        catch_up(self.port)
        if self.tracker is not None:
            self.tracker.skip()
        behind, stamped, heard = np.inf, np.inf, self.port.counts.received
        for _ in range(LISTEN):
            heard += 1
            if not self.port.wait(heard, self.port.robot.patience) or (report := self.port.report) is None:
                break
            now = self._now()
            behind, stamped = min(behind, now - report.counter / RATE), min(stamped, now - report.time)
        self._beside()
        self.port.start()
        assert (report := self.port.report) is not None  # the port does not start without one
        self.first, self.begun = report.counter + 1, report.time + 1.0 / RATE
        if self.tracker is not None:
            # when it is 0 on the tracker's clock, s after the trial's first report
            self.tracker_late = self.tracker.behind - behind - self.first / RATE
            self.tracker.skip()
        self.records.skip()
        if self.signals is not None:
            self.torque_late = self.signals.late(stamped)
            self.signals.samples.skip()

    def _open(self) -> None:
        robot, stack = self.cell.robot, self._stack
        stack.enter_context(self.port)
        if robot.has_torques and self.tracker is not None and self._feels:
            self.signals = torques_of(self.port, self._now)
            stack.enter_context(self.signals)
            await_torques(self.signals, self.port)
        if self.tracker is not None:
            stack.enter_context(self.tracker)
        if self._feels:
            stack.enter_context(ForceStream(self.cell.force_sensor, self.records, self._now, robot.patience))
        begin_motion_of(self.port)

    def unless_told(self, tell: Tell) -> Tell:
        """Return what tells of a graph's faults, but not again of those that the robot's wire has told."""

        def told(event: str, fields: Mapping[str, Any]) -> None:
            if event != "robot_fault" or not self.port.reason:
                tell(event, fields)

        return told

    @property
    def reports(self) -> int:
        """How many of its reports a trial has behind it, by the newest one's counter; as before while it is silent."""
        report = self.port.report
        return 0 if report is None else report.counter - self.first + 1


def begin_motion_of(port: RobotPort) -> None:
    """Have guided motion begun anew by the robot's program, where it has one and guided motion has ended.

    Parameters
    ----------
    port : RobotPort, open

    Raises
    ------
    LinkError : the program is not there, or refuses.
    """
    if port.robot.has_program:
        with program_of(port) as program:
            begin_motion(port, program)


def catch_up(port: RobotPort) -> None:
    """Wait until no report waits any more that came while something else kept this program busy.

    Parameters
    ----------
    port : RobotPort, open
    """
    apart = 0
    for _ in range(LISTEN):
        before = time.monotonic()
        if apart == _APART or not port.wait(port.skip() + 1, port.patience):
            return
        apart = apart + 1 if time.monotonic() - before > 0.5 / RATE else 0


def change_block(cell: CellConfig, is_there: bool, now: Callable[[], float] = time.monotonic) -> None:
    """Have the robot's program put a fresh block under the tool, or take it away.

    Parameters
    ----------
    cell : CellConfig
    is_there : bool
    now : callable() -> float, s, a monotonic clock

    Raises
    ------
    LinkError : the robot or its program is not there, or refuses.
    """
    with RobotPort(cell, now=now) as port, program_of(port) as program:
        program.change(is_there)
