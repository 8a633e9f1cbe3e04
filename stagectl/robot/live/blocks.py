"""What comes over the wires, as Blocks with the ports of the simulated robot, tracker and force sensor."""

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.robot.live.force_records import ForceRecords
from stagectl.robot.live.wires import LiveWires
from stagectl.robot.port import RobotPort
from stagectl.robot.wired_tracker import SPINDLE
from stagectl.wire.robot import Motion
from stagectl.wire.tracker import Sample

_TAKEN = 64
"""Samples of the torques' line that are taken at once."""


class LiveRobot(Block):
    """Hold the robot's newest report: the ports of `WiredPort`'s robot, and the motors' `torque` (N m, 6), out.

    `report` counts its reports from the trial's first, so that one that was lost leaves a gap.  `motors` is 1 while the
    robot can be led: motors on, guided motion running, no fault of the port latched.  Before its first report all is
    zero; while it is silent all stays.  `torque` is the newest of a line of its own.

    Parameters
    ----------
    wires : LiveWires
    """

    outputs = (
        Port("report"), Port("motors"), Port("motor_angle", "rad", 6), Port("planned_angle", "rad", 6),
        Port("torque", "N m", 6),
    )  # fmt: skip

    def __init__(self, wires: LiveWires) -> None:
        self.wires = wires

    def prepare(self, rate: float, frames: int) -> None:
        """Forget what was heard."""
        self._held = np.zeros(20)

    def process(
        self,
        report: np.ndarray,
        motors: np.ndarray,
        motor_angle: np.ndarray,
        planned_angle: np.ndarray,
        torque: np.ndarray,
    ) -> None:
        """Fill one frame."""
        held, wires = self._held, self.wires
        newest = wires.port.report
        if newest is not None and (reports := wires.reports) > 0:
            held[0] = reports
            held[2:8], held[8:14] = newest.joint_angle, newest.planned_angle
            runs = newest.motors_on and newest.motion is Motion.RUNNING
            held[1] = float(runs and not wires.port.reason)
        if wires.port.reason:
            held[1] = 0.0
        if wires.signals is not None:
            newest_torque = wires.signals.newest
            if np.isfinite(newest_torque[0]):
                held[14:] = newest_torque[7:]
        report[:], motors[:] = held[0], held[1]
        motor_angle[:], planned_angle[:], torque[:] = held[2:8], held[8:14], held[14:]


class LiveTorques(Block):
    """Hand out the samples of the torques' line one by one, a tick each: `logged_torque` (N m, 6), `torque_stamp` (s).

    The stamp is the controller's time since the trial's first report, before which a sample may have been taken.  Zero
    until one has come; then the newest that was handed out stays.

    Parameters
    ----------
    wires : LiveWires
    """

    outputs = (Port("torque_stamp", "s"), Port("logged_torque", "N m", 6))

    def __init__(self, wires: LiveWires) -> None:
        self.wires = wires

    def prepare(self, rate: float, frames: int) -> None:
        """Forget what was heard."""
        self._taken, self._at, self._count = np.zeros((_TAKEN, 13)), 0, 0
        self._stamp, self._torque = 0.0, np.zeros(6)

    def process(self, torque_stamp: np.ndarray, logged_torque: np.ndarray) -> None:
        """Hand out a sample for each of a frame, while there is one."""
        signals = self.wires.signals
        for n in range(len(torque_stamp)):
            if self._at == self._count and signals is not None:
                self._at, self._count = 0, signals.samples.take(self._taken)
            if self._at < self._count:
                row = self._taken[self._at]
                self._stamp, self._torque[:] = float(row[0]) + self.wires.torque_late - self.wires.begun, row[7:]
                self._at += 1
            torque_stamp[n, 0], logged_torque[n] = self._stamp, self._torque


class LiveTracker(Block):
    """Hand out the tracker's samples one by one, a tick each: the ports of `WiredTracker`'s tracker out.

    `stamp` (s) is the tracker's clock, set so that the quickest sample came at once after the robot's quickest report.
    After a pause of this program a sample waits for the tick that it belongs to.  A frame that is not in a sample has
    no LEDs.

    Parameters
    ----------
    wires : LiveWires, with a tracker
    """

    outputs = (
        Port("sample"), Port("stamp", "s"), Port("spindle", "1", 7), Port("workpiece", "1", 7), Port("leds", "1", 2),
        Port("residual", "m", 2),
    )  # fmt: skip

    def __init__(self, wires: LiveWires) -> None:
        assert wires.tracker is not None  # who opens the wires says so
        self.wires, self.samples = wires, wires.tracker
        self._frames = SPINDLE, wires.cell.tracker.frame

    def prepare(self, rate: float, frames: int) -> None:
        """Forget what was seen."""
        self._held, self._done, self._rate = np.zeros(20), 0, rate

    def process(
        self,
        sample: np.ndarray,
        stamp: np.ndarray,
        spindle: np.ndarray,
        workpiece: np.ndarray,
        leds: np.ndarray,
        residual: np.ndarray,
    ) -> None:
        """Hand out a sample for each of a frame, while there is one."""
        held = self._held
        for n in range(len(sample)):
            self._done += 1
            newest = self.samples.next(self._done / self._rate - self.wires.tracker_late)
            if newest is not None:
                self._hold(newest)
            sample[n, 0], stamp[n, 0] = held[0], held[1]
            spindle[n], workpiece[n], leds[n], residual[n] = held[2:9], held[9:16], held[16:18], held[18:]

    def _hold(self, newest: Sample) -> None:
        held = self._held
        held[0], held[1] = newest.counter, newest.time + self.wires.tracker_late
        held[2:] = 0.0
        for place, frame in enumerate(self._frames):
            for each in newest.sightings:
                if each.frame == frame and np.isfinite(each.residual) and np.isfinite(each.pose).all():
                    held[2 + 7 * place : 9 + 7 * place] = each.pose
                    held[16 + place], held[18 + place] = each.leds, each.residual


class LiveForce(Block):
    """Hand out what the force sensor has sent since the last tick as one record: `WiredForce`'s sensor's ports out.

    `measured` (1, 6: N and N m) is the mean of its records, `status` theirs; `sample` goes on by one and by those that
    were lost, and stays where none has come.

    Parameters
    ----------
    records : ForceRecords
    """

    outputs = (Port("measured", "1", 6), Port("sample"), Port("status"))

    def __init__(self, records: ForceRecords) -> None:
        self.records = records

    def prepare(self, rate: float, frames: int) -> None:
        """Forget what was felt."""
        self._measured, self._sample, self._status = np.zeros(6), 0.0, 0.0

    def process(self, measured: np.ndarray, sample: np.ndarray, status: np.ndarray) -> None:
        """Fill one frame."""
        taken = self.records.take()
        if taken is not None:
            record, missing = taken
            self._measured[:] = record.wrench
            self._status, self._sample = float(record.status), self._sample + 1.0 + missing
        measured[:], sample[:], status[:] = self._measured, self._sample, self._status


class LiveReference(Block):
    """Send the robot where a graph's port has it: `reference` (rad, 6) in; nothing once the port has latched.

    Parameters
    ----------
    port : RobotPort, of mode "joints"
    """

    inputs = (Port("reference", "rad", 6),)

    def __init__(self, port: RobotPort) -> None:
        self.port = port

    def process(self, reference: np.ndarray) -> None:
        """Hand over the newest sample."""
        if not self.port.reason:
            self.port.conversation.wanted.put(reference[-1], reference[-1])
