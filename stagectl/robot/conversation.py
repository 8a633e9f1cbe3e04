"""What is made of all that the robot says, and what it is answered: the port's state, and the fault that latches."""

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from rigkit.wire.layout import GarbledError, WireError
from stagectl.link.tell import Tell
from stagectl.robot.config import Robot
from stagectl.robot.guard import CommandGuard
from stagectl.robot.lag import Lag
from stagectl.wire.robot import RATE, Command, Motion, Outputs, Report, RobotWire
from stagectl.wire.sequence import Sequence

_JITTER = 0.5
"""Cycles by which a report may come after its time."""


class PortState(Enum):
    """What the port does."""

    IDLE = "idle"
    FOLLOWING = "following"
    HOLDING = "holding"


@dataclass
class ReportCounts:
    """What became of the robot's reports.

    Parameters
    ----------
    received, lost, late, garbled, foreign : int
        Lost: missing before the next one; late: after their turn, or twice; foreign: from another address.
    unanswered : int
        Reports for which no reference had come when the next one came.
    longest_gap : int, lost in a row
    overdue : int
        Answers that the controller has counted as late, where it counts.
    """

    received: int = 0
    lost: int = 0
    late: int = 0
    garbled: int = 0
    foreign: int = 0
    unanswered: int = 0
    longest_gap: int = 0
    overdue: int = 0


@dataclass(eq=False)
class Wanted:
    """A reference on its way to the wire: two halves, of which the writer fills one while the reader has the other.

    Parameters
    ----------
    width : int, 6 joints or 7 numbers of a pose
    """

    width: int
    number: int = 0
    nominal: np.ndarray = field(init=False)
    corrected: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        """Make room."""
        self.nominal, self.corrected = np.zeros((2, self.width)), np.zeros((2, self.width))

    def put(self, nominal: np.ndarray, corrected: np.ndarray) -> None:
        """Write a reference without and with its correction, each shape (width,), rad, or m and 1."""
        half = (self.number + 1) % 2
        self.nominal[half], self.corrected[half] = nominal, corrected
        self.number += 1  # last: from here on the reader sees it


def unheard(_: Report) -> None:
    """Hear nothing."""


class RobotConversation:
    """The port without its socket and thread: datagrams are put in and taken out, by one thread.

    Parameters
    ----------
    robot : Robot
    wire : RobotWire
        Of this conversation alone.
    guard : CommandGuard
    tell : callable(event, fields)
        Told of each fault, for the run's log.

    Attributes
    ----------
    outputs : Outputs or None
        What the controller's outputs are to be, where the wire carries them; None leaves them as they are.
    refused : str
        Why the last datagram that was none was not taken.
    heard_by : callable(Report)
        Told of each report that is taken.
    """

    outputs: Outputs | None
    heard_by: Callable[[Report], object]

    def __init__(self, robot: Robot, wire: RobotWire, guard: CommandGuard, tell: Tell) -> None:
        self.robot, self.guard = robot, guard
        self.outputs, self.refused, self.heard_by = None, "", unheard
        self.state, self.reason = PortState.IDLE, ""
        self.counts, self.report = ReportCounts(), None
        self.heard, self.peer = -np.inf, None
        self.wanted = Wanted(guard.width)
        self._tell, self._wire, self._sequence, self._lag = tell, wire, Sequence(wire.modulus), Lag()
        self._is_due, self._answered, self._taken, self._late_references = False, 0, 0, 0
        self._counter, self._has_followed = 0, False

    report: Report | None
    peer: tuple[str, int] | None

    @property
    def where(self) -> np.ndarray:
        """Where the robot is asked to be: angles, shape (6,), rad, or where its tool is, shape (7,), m and 1."""
        if self.report is None:
            return np.full(self.guard.width, np.nan)
        return self.report.planned_angle if self.guard.mode == "joints" else self.report.pose

    def count_from(self, counter: int) -> None:
        """Let the next answer have the counter after this one."""
        self._counter = counter

    def begin(self) -> None:
        """Let references go out, from where the robot is; it is held there until the first has come."""
        self.guard.place(self.where)
        self.guard.release()
        self.counts.longest_gap = 0
        self._taken, self._late_references, self._has_followed = self.wanted.number, 0, False
        self.state = PortState.FOLLOWING

    def end(self) -> None:
        """Hold the robot where it is; no fault."""
        if self.state is PortState.FOLLOWING:
            self.guard.hold()
            self.state = PortState.HOLDING

    def clear(self) -> None:
        """Forget the fault: a person has acknowledged."""
        self.reason = ""

    def latch(self, reason: str) -> None:
        """Keep the first reason, and hold the robot."""
        self.guard.hold()
        if not self.reason:
            self.reason, self.state = reason, PortState.HOLDING
            self._tell("robot_fault", {"reason": reason})

    def take(self, data: bytes, sender: tuple[str, int], now: float) -> None:
        """Take a datagram from the socket."""
        if self.robot.address not in ("", sender[0]) or (self.peer or sender)[0] != sender[0]:
            self.counts.foreign += 1
            self.refused = f"a datagram of {sender[0]}, must be of {self.robot.address or (self.peer or sender)[0]}"
            return
        try:
            report = self._wire.read(data)
        except GarbledError as fault:
            self.counts.garbled += 1
            self.refused = str(fault)
            return
        missing = self._sequence.accept(report.counter)
        if missing < 0:
            self.counts.late += 1
            return
        self._accept(report, sender, missing, now)

    def give(self) -> bytes | None:
        """Return the answer to the last report, once there is one: a new reference, or the hold."""
        if not self._is_due:
            return None
        if self.state is PortState.FOLLOWING and self.wanted.number != self._taken:
            self._follow()
        elif self.state is not PortState.FOLLOWING or not self._has_followed:
            self.guard.rest()
        else:
            return None
        return self._answer()

    def watch(self, now: float) -> None:
        """Look whether the robot is still with us; call it only when all that has come is taken."""
        silence = now - self.heard
        if silence * RATE <= self.robot.silence + _JITTER:
            return
        if self.state is PortState.FOLLOWING:
            self.latch(
                f"the robot is silent for {silence:.3g} s, must be <= {self.robot.silence} cycles{self.why_refused}"
            )
        if self.report is not None:
            self._forget()

    @property
    def why_refused(self) -> str:
        """What is wrong with the last datagram that was not taken, to be added to a reason; or nothing."""
        return f"; the last one was refused: {self.refused}" if self.refused else ""

    def _accept(self, report: Report, sender: tuple[str, int], missing: int, now: float) -> None:
        counts, fresh = self.counts, not np.isfinite(self.heard)
        counts.received += 1
        counts.lost += missing
        counts.longest_gap = max(counts.longest_gap, missing)
        counts.overdue, self.refused = report.overdue, ""
        lag = self._lag.take(report.time, now)
        self.report, self.peer, self.heard = report, sender, now
        self.heard_by(report)
        if fresh:
            self.guard.place(self.where)
        if self.state is PortState.FOLLOWING:
            self._judge(report, missing, lag)
        if self._is_due and self.state is PortState.FOLLOWING:
            self._miss()
        self._is_due = True

    def _judge(self, report: Report, missing: int, lag: float) -> None:
        if not report.motors_on:
            self.latch("the robot's motors are off")
        elif report.fault:
            self.latch(report.fault)
        elif report.motion is not Motion.RUNNING:
            self.latch(f"the robot has left guided motion: {report.motion.name}")
        elif missing >= self.robot.silence:
            self.latch(f"{missing} reports from the robot are lost in a row, must be < {self.robot.silence}")
        elif not lag <= self.robot.lag:
            self.latch(f"a report from the robot comes {lag:.3g} s late, must be <= {self.robot.lag:g} s")

    def _miss(self) -> None:
        """Count a report without a reference; the robot keeps what it had."""
        self.counts.unanswered += 1
        self._late_references += 1
        if self._late_references >= self.robot.silence:
            self.latch(f"no reference for {self._late_references} cycles, must be < {self.robot.silence}")

    def _follow(self) -> None:
        self._taken, self._late_references, self._has_followed = self.wanted.number, 0, True
        half = self._taken % 2
        wanted = self.wanted.corrected[half]
        reason = self._wire.refusal(wanted) or self.guard.take(self.wanted.nominal[half], wanted)
        if reason:
            self.latch(reason)
            self.guard.rest()

    def _answer(self) -> bytes | None:
        assert self.report is not None  # an answer is due
        self._is_due = False
        self._counter += 1
        kind = "joint_angle" if self.guard.mode == "joints" else "pose"
        command = Command(self._counter, self.report.time, **{kind: self.guard.sent}, outputs=self.outputs)
        try:
            return self._wire.write(command, self.report)
        except WireError as fault:  # nobody knows where the tool is: `RobotPort.start` says so
            self.refused = str(fault)
            return None

    def _forget(self) -> None:
        """Take the next report as the first: what the robot did meanwhile is not known, nor whether it is the same."""
        self._sequence.reset()
        self._lag.forget()
        self._wire.forget()
        self.report, self.peer, self.heard, self._is_due = None, None, -np.inf, False
