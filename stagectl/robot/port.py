"""The robot port: open it, start and stop following, and acknowledge what went wrong."""

import time
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import Self

import numpy as np

from rigkit.latch import to_clear
from stagectl.link.bus import LinkError
from stagectl.link.robot_datagrams import Datagrams
from stagectl.link.tell import Tell, nobody
from stagectl.robot.arm import Arm, ArmError, irb140, read_arm
from stagectl.robot.config import CellConfig
from stagectl.robot.conversation import PortState, ReportCounts, RobotConversation
from stagectl.robot.guard import CommandGuard
from stagectl.wire.makes import ROBOTS
from stagectl.wire.robot import RATE, Motion, Report


class RobotFault(LinkError):
    """The port has latched: a person must find out why, and acknowledge."""


def arm_of(config: CellConfig) -> Arm:
    """Return the arm that the cell's file names; ArmError where there is none."""
    name = config.robot.arm
    if name == "irb140":
        return irb140()
    if name == "kuka":
        return read_arm(str(files("stagectl.robot").joinpath("kuka.toml")))
    if not Path(name).is_file():
        raise ArmError(f"the arm is {name!r}, must be irb140, kuka, or an arm's file")
    return read_arm(name)


class RobotPort:
    """The robot behind its make's wire: a context manager that listens, and holds the robot until `start`.

    Whatever goes wrong while the robot follows - it is silent, leaves guided motion, its reports are lost or late, no
    reference comes for it, a reference is beyond a limit, or `hold` is called - latches: what is sent comes to rest and
    stays, the Blocks raise `RobotFault`, which stops their clock, and `reason` says why.  Nothing starts again by
    itself: `acknowledge`, then `start`.

    Parameters
    ----------
    config : CellConfig
    tell : callable(event, fields)
        Told of each fault and acknowledgement, for the run's log.
    now : callable() -> float, s, a monotonic clock

    Raises
    ------
    LinkError : on entry, when the socket cannot be had or the robot is not heard.
    """

    def __init__(self, config: CellConfig, tell: Tell = nobody, now: Callable[[], float] = time.monotonic) -> None:
        self.config, self.robot = config, config.robot
        self._tell, self._now = tell, now
        guard = CommandGuard(arm_of(config), config.limits, config.robot.mode, config.robot.tool)
        self.conversation = RobotConversation(config.robot, ROBOTS[config.robot.wire](), guard, tell)
        # a robot that an earlier port has led must not take this one's commands for late ones
        self.conversation.count_from(int(now() * RATE))
        patience = 0.5 / RATE
        self._carrier = Datagrams(config.robot.listen, config.robot.port, self.conversation, now, patience)

    def __enter__(self) -> Self:
        """Listen until the robot is heard."""
        self._carrier.open()
        if not self.until(lambda: self.conversation.report is not None, self.robot.patience):
            self._carrier.close()
            host, port = self.address
            why = self.conversation.why_refused
            raise LinkError(f"no report from the robot on {host}:{port} within {self.robot.patience:g} s{why}")
        return self

    def __exit__(self, *_: object) -> None:
        """Hold the robot, and close the socket."""
        self.stop()
        self._carrier.close()

    @property
    def address(self) -> tuple[str, int]:
        """Where the robot is to send its reports, once open: address and UDP port."""
        return self._carrier.address

    @property
    def beat(self) -> str:
        """What the robot sends in time."""
        return "report from the robot"

    @property
    def host(self) -> str:
        """The robot's address, once it was heard."""
        peer = self.conversation.peer
        return peer[0] if peer is not None else self.robot.listen

    @property
    def rate(self) -> float:
        """Reports/s."""
        return RATE

    @property
    def frames(self) -> int:
        """Samples of a report."""
        return 1

    @property
    def patience(self) -> float:
        """Longest time without a report before it is given up, s."""
        return self.robot.patience

    @property
    def reason(self) -> str:
        """What has latched, or nothing."""
        return self.conversation.reason

    @property
    def state(self) -> PortState:
        """What the port does."""
        return self.conversation.state

    @property
    def counts(self) -> ReportCounts:
        """What became of the robot's reports."""
        return self.conversation.counts

    @property
    def report(self) -> Report | None:
        """The newest report; None while the robot is silent."""
        return self.conversation.report

    @property
    def sent(self) -> np.ndarray:
        """What was sent last, after the limits: angles, shape (6,), rad, or a pose, shape (7,), m and 1."""
        return self.conversation.guard.sent

    def start(self) -> None:
        """Let the robot follow references, from where it is.

        Raises
        ------
        RobotFault : a fault is latched.
        LinkError : the robot is not heard, its motors are off, or it is not in guided motion.
        """
        self.refuse_when_latched()
        report = self.conversation.report
        if report is None:
            raise LinkError("the robot cannot start: it is silent")
        if not (report.motors_on and report.motion is Motion.RUNNING and np.isfinite(self.conversation.where).all()):
            motors = "on" if report.motors_on else "off"
            raise LinkError(
                f"the robot cannot start: its motors are {motors}, guided motion is {report.motion.name}, it is at "
                f"{self.conversation.where}; must be on, RUNNING, and at finite numbers"
            )
        self._carrier.ask(self.conversation.begin)

    def stop(self) -> None:
        """Hold the robot where it is."""
        self._carrier.ask(self.conversation.end)

    def hold(self, reason: str) -> None:
        """Hold the robot for a reason from elsewhere, such as a blind tracker; latches."""
        if self.state is PortState.FOLLOWING:
            self._carrier.ask(lambda: self.conversation.latch(reason))

    def acknowledge(self, by: str) -> str:
        """End a fault, in the name of the person who found out why, and return what it was.

        Raises
        ------
        ValueError : nobody is named, or there is no fault.
        LinkError : the robot is silent.
        """
        reason = to_clear("the robot port", self.reason, by)
        if self.conversation.report is None:
            raise LinkError(f"{by} cannot acknowledge yet: the robot is silent")
        self._carrier.ask(self.conversation.clear)
        self._tell("robot_acknowledged", {"by": by, "reason": reason})
        return reason

    def refuse_when_latched(self) -> None:
        """Raise `RobotFault` while a fault is latched."""
        if self.reason:
            raise RobotFault(f"{self.reason}; a person must acknowledge")

    def skip(self) -> int:
        """Return how many reports have come in all, for `wait`."""
        return self.counts.received

    def wait(self, samples: int, seconds: float) -> bool:
        """Return True as soon as so many reports have come in all, False on a fault or after `seconds`."""
        counts = self.conversation.counts
        self.until(lambda: counts.received >= samples or bool(self.reason), seconds)
        return counts.received >= samples and not self.reason

    def flush(self) -> None:
        """Have the reference that waits sent now."""
        self._carrier.flush()

    def until(self, met: Callable[[], bool], seconds: float) -> bool:
        """Return whether `met` holds, as soon as something has come after which it does, or after `seconds`."""
        with self._carrier.arrived:
            return self._carrier.arrived.wait_for(met, seconds)
