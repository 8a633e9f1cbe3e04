"""What the robot's controller does beside motion, by its make: its program, and the motors' torques."""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from typing import Self

import numpy as np

from rigkit.ring import Ring
from stagectl.link.bus import LinkError
from stagectl.robot.port import RobotPort
from stagectl.robot.program import KEPT, Program, RobotProgram, Torques, TorqueSignals
from stagectl.wire.robot import Outputs, Report


class OutputProgram:
    """Sets the controller's digital outputs within the messages, and waits until they are read back.

    Soft servo is not among them: no message of such a make carries it.

    Parameters
    ----------
    port : RobotPort, open
        Of a wire that is whole.
    """

    def __init__(self, port: RobotPort) -> None:
        self._port = port

    def __enter__(self) -> Self:
        """Be open already."""
        return self

    def __exit__(self, *_: object) -> None:
        """Leave the outputs as they are."""

    def soften(self, softness: Sequence[float]) -> None:
        """Refuse soft servo, by LinkError, unless all joints are to be stiff, which they are."""
        if any(each != 0.0 for each in softness):
            raise LinkError(
                f"soft servo is {', '.join(f'{each:g}' for each in softness)}, must be 0 over robot.wire "
                f"{self._port.robot.wire}: its messages do not carry it"
            )

    def clamp(self, is_clamped: bool) -> None:
        """Close the clamp that holds the tool, or open it."""
        self._set("clamp", is_clamped)

    def change(self, is_there: bool) -> None:
        """Have a fresh workpiece put under the tool, or taken away, by a changer of the robot's own."""
        self._set("block", is_there)

    def reset(self) -> None:
        """Refuse, by LinkError: a person begins at the controller."""
        raise LinkError(
            f"guided motion over robot.wire {self._port.robot.wire} cannot be begun from here: a person starts the "
            "robot's program at its pendant"
        )

    def _set(self, name: str, value: bool) -> None:
        talk, patience = self._port.conversation, self._port.robot.patience
        now = talk.outputs or (talk.report.outputs if talk.report is not None else None) or Outputs()
        talk.outputs = Outputs(**{"clamp": now.clamp, "block": now.block, name: value})

        def is_set() -> bool:
            read = None if talk.report is None else talk.report.outputs
            return read is not None and getattr(read, name) is value

        if not self._port.until(is_set, patience):
            raise LinkError(f"the controller's output {name} is not {int(value)} within {patience:g} s")


class ReportedTorques:
    """Makes torques of the currents in the robot's own reports: each times `robot.torque_constant`.

    Friction of motor and gear, and what the current loop does not show, are in them: they are no joint torques.

    Parameters
    ----------
    port : RobotPort, open
        Of a wire that is whole.
    """

    def __init__(self, port: RobotPort) -> None:
        self.garbled = self.losses = 0  # a line that is down is the port's own silence
        self.samples = Ring(13, KEPT)
        self.newest = np.full(13, np.nan)
        self._port, self._constant = port, np.array(port.robot.torque_constant)
        self._gear = port.robot.gear

    def __enter__(self) -> Self:
        """Begin to listen."""
        self._port.conversation.heard_by = self.hear
        return self

    def __exit__(self, *_: object) -> None:
        """Listen no more."""
        self._port.conversation.heard_by = lambda _: None

    def wait(self, samples: int, seconds: float) -> bool:
        """Return whether so many samples have come in all, as soon as they have or after `seconds`."""
        return self._port.until(lambda: self.samples.offered >= samples, seconds)

    def late(self, behind: float) -> float:  # noqa: ARG002 (they are in the reports)
        """Return 0 s: they have the times of the reports."""
        return 0.0

    def hear(self, report: Report) -> None:
        """Take a report; called by the port's thread."""
        if report.current is None:
            self.garbled += 1
            return
        torque = self._constant * report.current @ self._gear  # the reports' angles are the joints' already
        sample = np.concatenate([[report.time], report.joint_angle, torque])
        self.samples.put(sample[None])
        self.newest = sample  # a new array each time: a reader has the old or the new one


def program_of(port: RobotPort) -> AbstractContextManager[Program]:
    """Return what asks the robot's program, to be entered.

    Parameters
    ----------
    port : RobotPort, open
        Whose `robot.has_program`.

    Raises
    ------
    LinkError : it cannot be connected to.
    """
    return OutputProgram(port) if port.robot.is_whole else RobotProgram(port.robot, port.host)


def torques_of(port: RobotPort, now: Callable[[], float]) -> Torques:
    """Return what reads the motors' torques, to be entered.

    Parameters
    ----------
    port : RobotPort, open
        Whose `robot.has_torques`.
    now : callable() -> float, s, a monotonic clock
    """
    return ReportedTorques(port) if port.robot.is_whole else TorqueSignals(port.robot, port.host, now)


def await_torques(torques: Torques, port: RobotPort) -> None:
    """Wait for a first sample; LinkError where none comes."""
    if not torques.wait(1, port.robot.patience):
        where = "in its reports" if port.robot.is_whole else f"from {port.host}:{port.robot.signals}"
        raise LinkError(f"no torque signals come {where} within {port.robot.patience:g} s")
