"""The program on the robot's controller beside guided motion: soft servo, clamp, brakes; and its torque signal.

Guided motion carries no torques before RobotWare 7, so they come on a line of their own, as from a signal logger.
"""

import math
from collections.abc import Callable, Sequence
from typing import Protocol, Self

import numpy as np

from rigkit.ring import Ring
from stagectl.link.bus import LinkError
from stagectl.link.robot_stream import Requests, Stream
from stagectl.robot.config import Robot
from stagectl.robot.gears import joint_side
from stagectl.robot.port import RobotPort
from stagectl.wire.robot import RATE, Motion

KEPT = 8 * round(RATE)
"""Samples of torque kept for a reader that stands still: 8 s."""
_LONGEST_LINE = 1_000
_ONE_CLOCK = 1.0
"""s: a line whose stamps are further than that from those of the reports has a clock of its own."""


class Program(Protocol):
    """What the controller does beside motion; each raises LinkError where it refuses."""

    def soften(self, softness: Sequence[float]) -> None:
        """Turn joints soft: the part of the P gain that is taken away, a number a joint, 0 to 0.99; 0 for stiff."""

    def clamp(self, is_clamped: bool) -> None:
        """Close the clamp that holds the tool, or open it."""

    def change(self, is_there: bool) -> None:
        """Have a fresh workpiece put under the tool, or taken away, by a changer of the robot's own."""

    def reset(self) -> None:
        """Switch the motors on again, and begin guided motion anew where the robot is."""


class Torques(Protocol):
    """The motors' torques: a context manager that reads all the time.

    Attributes
    ----------
    samples : Ring
        Rows of time (s, the controller's clock), 6 angles (rad), 6 torques (N m).
    newest : array, shape (13,), such a row; NaN until one has come
    losses : int, how often the line has gone down
    """

    samples: Ring
    newest: np.ndarray
    losses: int

    def __enter__(self) -> Self:
        """Begin to read."""

    def __exit__(self, *_: object) -> None:
        """Read no more."""

    def wait(self, samples: int, seconds: float) -> bool:
        """Return whether so many samples have come in all, as soon as they have or after `seconds`."""

    def late(self, behind: float) -> float:
        """Return what is added to their times, s, to be on the clock of reports that is `behind` ours by so much."""


class RobotProgram:
    """Asks the program on the robot's controller, line by line; each answer is OK, or ERROR and why.

    Parameters
    ----------
    robot : Robot
    host : str, the controller's address
    """

    def __init__(self, robot: Robot, host: str) -> None:
        self._requests = Requests(host, robot.commands, robot.patience)

    def __enter__(self) -> Self:
        """Be open already."""
        return self

    def __exit__(self, *_: object) -> None:
        """Hang up."""
        self._requests.close()

    def soften(self, softness: Sequence[float]) -> None:
        """Turn joints soft: the part of the P gain that is taken away, a number a joint, 0 to 0.99; 0 for stiff."""
        self._do("SOFT " + " ".join(f"{each:.6g}" for each in softness))

    def clamp(self, is_clamped: bool) -> None:
        """Close the clamp that holds the tool, or open it."""
        self._do(f"CLAMP {int(is_clamped)}")

    def change(self, is_there: bool) -> None:
        """Have a fresh workpiece put under the tool, or taken away, by a changer of the robot's own."""
        self._do(f"BLOCK {int(is_there)}")

    def reset(self) -> None:
        """Switch the motors on again, and begin guided motion anew where the robot is."""
        self._do("RESET")

    def _do(self, line: str) -> None:
        answer = self._requests.ask(line)
        if answer != "OK":
            raise LinkError(f"the robot's program refuses {line!r}: {answer}")


def begin_motion(port: RobotPort, program: Program) -> None:
    """Have guided motion begun anew where the robot is, if it has ended by its time-out since nobody led it.

    Parameters
    ----------
    port : RobotPort, open
        Motors that are off stay off: `RobotPort.start` refuses them.
    program : Program, open

    Raises
    ------
    LinkError : the program refuses.
    """
    report = port.report
    if report is None or report.motion is not Motion.STOPPED or not report.motors_on:
        return
    program.reset()
    reports = port.counts.received
    while (report := port.report) is not None and report.motion is not Motion.RUNNING:
        reports += 1
        if not port.wait(reports, port.robot.patience):
            return


class TorqueSignals:
    """Reads lines "time, 6 angles (deg), 6 torques (N m)" from the controller's signal line.

    The line's are those of the motors, seen from the arm's side of the gears; `robot.coupling` makes joints' of them.

    Parameters
    ----------
    robot : Robot
    host : str, the controller's address
    now : callable() -> float, s, a monotonic clock

    Attributes
    ----------
    garbled, losses : int
        Lines that were none, and times that the connection went down.
    """

    def __init__(self, robot: Robot, host: str, now: Callable[[], float]) -> None:
        self.garbled = self.losses = 0
        self.samples = Ring(13, KEPT)
        self.newest = np.full(13, np.nan)
        self._rest, self._behind, self._gear = b"", np.inf, robot.gear
        self._stream = Stream(host, robot.signals, self, now)

    def __enter__(self) -> Self:
        """Begin to read."""
        self._stream.open()
        return self

    def __exit__(self, *_: object) -> None:
        """Hang up."""
        self._stream.close()

    def wait(self, samples: int, seconds: float) -> bool:
        """Return whether so many samples have come in all, as soon as they have or after `seconds`."""
        with self._stream.arrived:
            return self._stream.arrived.wait_for(lambda: self.samples.offered >= samples, seconds)

    def late(self, behind: float) -> float:
        """Return what is added to their times, s, to be on the clock of reports that are `behind` ours by so much, s.

        Nothing, where both are stamped by one clock; else by the sample and the report that came quickest.
        """
        apart = self._behind - behind
        return apart if abs(apart) > _ONE_CLOCK else 0.0

    def take(self, data: bytes, now: float) -> None:
        """Take bytes from the line."""
        *lines, self._rest = (self._rest + data).split(b"\n")
        self._rest = self._rest[-_LONGEST_LINE:]
        for line in lines:
            self._read(line, now)

    def watch(self, now: float) -> None:
        """Nothing hangs on its being there in time."""

    def lose(self) -> None:
        """Begin a new line when it is back."""
        self._rest, self.newest, self._behind = b"", np.full(13, np.nan), np.inf
        self.losses += 1

    def _read(self, line: bytes, now: float) -> None:
        try:
            values = [float(each) for each in line.split(b",")]
        except ValueError:
            values = []
        if len(values) != 13 or not all(map(math.isfinite, values)):
            self.garbled += 1
            return
        sample = np.array(values)
        sample[1:7], sample[7:] = joint_side(np.radians(sample[1:7]), sample[7:], self._gear)
        self.samples.put(sample[None])
        self.newest, self._behind = sample, min(self._behind, now - values[0])
