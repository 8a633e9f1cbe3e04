"""What every make of robot says and is asked for, in SI, and what a make's wire does: bytes <-> these."""

from dataclasses import dataclass
from enum import IntEnum
from typing import Protocol

import numpy as np

RATE = 250.0
"""Reports/s."""


class Motion(IntEnum):
    """What guided motion does (ABB's EgmMCIState)."""

    UNDEFINED, ERROR, STOPPED, RUNNING = range(4)


@dataclass(frozen=True)
class Outputs:
    """Digital outputs of the controller: the clamp is closed; a workpiece is there."""

    clamp: bool = False
    block: bool = False


@dataclass(frozen=True, eq=False)
class Report:
    """What the robot says in each cycle.

    Parameters
    ----------
    counter : int, one more each cycle
    time : float, s, the controller's clock
    joint_angle, planned_angle : arrays, shape (6,), rad
        Of the motors behind their gears: measured, and asked for.
    pose : array, shape (7,), m and 1
        Of the tool: position, then the unit quaternion w x y z; NaN where it is not sent.
    motors_on, program_runs : bool
    motion : Motion
    stamp : int
        What the answer to it has to repeat.
    overdue : int
        Answers that the controller has counted as late; 0 where it does not count.
    current : array, shape (6,), A, of the motors; None where it is not sent
    outputs : Outputs or None
        As they are read back; None where they are not sent.
    fault : str
        What is wrong by the make's own rules; nothing where all is well.
    """

    counter: int
    time: float
    joint_angle: np.ndarray
    planned_angle: np.ndarray
    pose: np.ndarray
    motors_on: bool = True
    program_runs: bool = True
    motion: Motion = Motion.RUNNING
    stamp: int = 0
    overdue: int = 0
    current: np.ndarray | None = None
    outputs: Outputs | None = None
    fault: str = ""


@dataclass(frozen=True, eq=False)
class Command:
    """What the robot is asked for: joint angles, shape (6,), rad, or a pose, shape (7,), m and 1; the other is None.

    `outputs` are left as they are where they are None.
    """

    counter: int
    time: float
    joint_angle: np.ndarray | None = None
    pose: np.ndarray | None = None
    outputs: Outputs | None = None


class RobotWire(Protocol):
    """A make's messages in one conversation, without I/O.

    Attributes
    ----------
    modulus : int
        Where `Report.counter` begins again.
    is_whole : bool
        Whether currents and outputs go within the messages; else torques and the program have lines of their own.
    """

    modulus: int
    is_whole: bool

    def read(self, data: bytes) -> Report:
        """Return a report; `GarbledError` that names what is wrong."""

    def write(self, command: Command, report: Report) -> bytes:
        """Return the answer to a report; `WireError` where the command cannot be sent."""

    def refusal(self, wanted: np.ndarray) -> str:
        """Say why joint angles, shape (6,), rad, or a pose, shape (7,), m and 1, cannot be asked for, or nothing."""

    def forget(self) -> None:
        """Take the next report as the first: the robot was silent."""
