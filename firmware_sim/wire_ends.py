"""The controller's end of each make of wire, by its name in the cell's file: ABB's guided motion, KUKA's RSI."""

from collections.abc import Callable

import numpy as np

from firmware_sim.robot_controller import RobotController, WireEnd
from firmware_sim.robot_inverse import toward
from rigkit.wire.layout import GarbledError
from stagectl.wire import egm, rsi
from stagectl.wire.robot import RATE, Motion, Outputs, Report
from stagectl.wire.sequence import Sequence

LATE = 150_000
"""Cycles in a row without an answer in time, after which RSI is switched off: ten minutes, as the context has it."""
_FARTHEST = np.repeat([rsi.SHIFT, rsi.TURN], 3)
FIRST_IPOC = 4_208_163_634
"""ms: where the controller's time stamp was when it was switched on."""


class EgmEnd:
    """Guided motion's end: the counters and time-out of its commands."""

    def __init__(self) -> None:
        self._sequence = Sequence(egm.MODULUS)

    def take(self, data: bytes, robot: RobotController) -> bool:
        """Take a command; late, doubled and garbled ones are counted."""
        try:
            command = egm.unpack_command(data)
        except GarbledError:
            robot.counts.garbled += 1
            return False
        if self._sequence.accept(command.counter) < 0:
            robot.counts.late += 1
            return False
        if command.joint_angle is not None:
            robot.ask(command.joint_angle)
        elif robot.motion is Motion.RUNNING:
            assert command.pose is not None  # a command has one of the two
            robot.ask(toward(robot.plant, robot.asked, command.pose))
        return True

    def look(self, robot: RobotController) -> None:
        """Stop when no command has come for its patience, after the first."""
        if robot.has_command and robot.idle > robot.setup.patience * RATE:
            robot.stop(Motion.STOPPED)

    def say(self, robot: RobotController) -> bytes:
        """Return the cycle's report."""
        on, runs, angle = not robot.plant.tripped, robot.motion is Motion.RUNNING, robot.motor_angle[0].copy()
        pose = robot.rigid_pose(angle)
        report = Report(robot.cycle, robot.time, angle, robot.reference.copy(), pose, on, runs, robot.motion)
        return egm.pack_report(report)

    def begin(self, robot: RobotController) -> None:  # noqa: ARG002 (it is the same wherever the robot is)
        """Take the next command as the first."""
        self._sequence.reset()


class RsiEnd:
    """The Robot Sensor Interface's end, from RSI_ON on: IPOC, late answers, corrections within their limits.

    An answer counts that repeats the newest IPOC, and comes before the next cycle; else the last correction stays, and
    the cycle is counted as late.  After so many in a row RSI is switched off, as it is when the motors are: nothing is
    sent any more until a person starts the program again.  Corrections beyond AXISCORR and POSCORR are clamped, without
    a word; a jump further than `GuidedMotion.farthest` ends it, as a drive's monitoring would.  Not modelled: jitter of
    the controller's cycle, its overall limits AXISCORRMON and POSCORRMON, RSI's relative mode; its lag is that of
    guided motion, since none is known for RSI.

    Parameters
    ----------
    late : int, cycles
    """

    def __init__(self, late: int = LATE) -> None:
        self._most, self.late, self._in_a_row = late, 0, 0
        self._base, self._frame, self._joints, self._shift = np.zeros(6), np.zeros(7), np.zeros(6), np.zeros(6)
        self._ipoc, self._is_answered = 0, True
        self._outputs: Outputs | None = None

    def take(self, data: bytes, robot: RobotController) -> bool:
        """Take an answer; one of another IPOC, or a second one, is late; garbled ones are counted."""
        try:
            ipoc, joints, frame, outputs = rsi.unpack_answer(data)
        except GarbledError:
            robot.counts.garbled += 1
            return False
        if ipoc != self._ipoc or self._is_answered or robot.motion is not Motion.RUNNING:
            robot.counts.late += 1
            return False
        self._is_answered = True
        self._switch(outputs, robot)
        robot.ask(self._wanted(joints, frame, robot))
        return True

    def look(self, robot: RobotController) -> None:
        """Count the last cycle, where it was not answered, and give up after too many in a row."""
        self._in_a_row = 0 if self._is_answered else self._in_a_row + 1
        self.late += not self._is_answered
        if self._in_a_row > self._most:
            robot.stop(Motion.STOPPED)

    def say(self, robot: RobotController) -> bytes | None:
        """Return the cycle's telegram; nothing while RSI is switched off."""
        if robot.motion is not Motion.RUNNING:
            return None
        self._ipoc, self._is_answered = FIRST_IPOC + rsi.PERIOD * robot.cycle, False
        angle = robot.motor_angle[0].copy()
        report = Report(
            robot.cycle,
            robot.time,
            angle,
            self._base + self._joints if self._shift.any() else robot.reference.copy(),
            robot.rigid_pose(angle),
            stamp=self._ipoc,
            overdue=self.late,
            current=robot.torque[0],
            outputs=self._outputs,
        )
        return rsi.pack_telegram(report, self._base, self._frame, self._shift)

    def begin(self, robot: RobotController) -> None:
        """Switch RSI on where the robot is."""
        self._base = robot.reference.copy()
        self._frame = robot.rigid_pose(self._base)
        self._joints, self._shift = np.zeros(6), np.zeros(6)
        self.late, self._in_a_row, self._is_answered = 0, 0, True
        self._outputs = self._outputs or Outputs(block=robot.has_block)

    def _wanted(self, joints: np.ndarray, frame: np.ndarray, robot: RobotController) -> np.ndarray:
        self._joints = np.clip(joints, -rsi.REACH, rsi.REACH)
        self._shift = np.clip(frame, -_FARTHEST, _FARTHEST)
        if not self._shift.any():
            return np.asarray(self._base + self._joints)
        pose = self._frame.copy()
        pose[:3] += self._shift[:3]
        pose[3:] = _turned(pose[3:], self._shift[:2:-1])
        return np.asarray(toward(robot.plant, robot.asked, pose) + self._joints)

    def _switch(self, outputs: Outputs, robot: RobotController) -> None:
        """Do what the program does when an output changes; one that it refuses is not read back."""
        before = self._outputs or Outputs()
        clamp = outputs.clamp != before.clamp and robot.do(f"CLAMP {int(outputs.clamp)}") == "OK"
        block = outputs.block != before.block and robot.do(f"BLOCK {int(outputs.block)}") == "OK"
        self._outputs = Outputs(before.clamp ^ clamp, before.block ^ block)


ENDS: dict[str, Callable[[int], WireEnd]] = {"egm": lambda _: EgmEnd(), "rsi": RsiEnd}
"""By `robot.wire`; made with `robot.late`."""


def _turned(quaternion: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Return a unit quaternion turned by a small vector, shape (3,), rad, in the base."""
    w, v, half = quaternion[0], quaternion[1:], 0.5 * turn
    made = np.concatenate([[w - half @ v], v + w * half + np.cross(half, v)])
    return np.asarray(made / np.linalg.norm(made))
