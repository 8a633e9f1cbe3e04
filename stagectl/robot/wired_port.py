"""The robot port within a graph: the same conversation as over UDP, without socket and thread, in the graph's time."""

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.link.tell import Tell, nobody
from stagectl.robot.config import CellConfig
from stagectl.robot.conversation import PortState, RobotConversation
from stagectl.robot.guard import CommandGuard
from stagectl.robot.port import arm_of
from stagectl.wire.egm import Egm, pack_report, unpack_command
from stagectl.wire.robot import RATE, Motion, Report

AFTERWARDS = 0.5
"""s that are recorded of a hold, beside `limits.stop`."""
_SENDER = ("graph", 0)


class WiredPort(Block):
    """Ask a robot in the same graph for joint angles, under the limits, time-outs and reasons of `RobotPort`.

    Ports: of the robot `report` (1), how many reports it has sent, `motors` (1 while they are on), `motor_angle` and
    `planned_angle` (rad, 6), and of the controllers `nominal`, its path, and `correction`, added to it (rad, 6), in;
    `reference` (rad, 6), and `holding` (1 unless it follows) out.

    Parameters
    ----------
    config : CellConfig
    first : array, shape (6,), rad
        What is asked for until the robot has reported.
    tell : callable(event, fields)
        Told of a fault.
    """

    inputs = (
        Port("report"), Port("motors"), Port("motor_angle", "rad", 6), Port("planned_angle", "rad", 6),
        Port("nominal", "rad", 6), Port("correction", "rad", 6),
    )  # fmt: skip
    outputs = (Port("reference", "rad", 6), Port("holding"))

    def __init__(self, config: CellConfig, first: np.ndarray, tell: Tell = nobody) -> None:
        self._config, self._first, self._tell = config, np.array(first, float), tell

    def prepare(self, rate: float, frames: int) -> None:
        """Hold the robot, with nothing heard."""
        config = self._config
        guard = CommandGuard(arm_of(config), config.limits, "joints", config.robot.tool)
        self.conversation = RobotConversation(config.robot, Egm(), guard, self._tell)
        self._seen, self._done, self._rate = 0.0, 0, rate
        self._asked, self._corrected, self._pose = self._first.copy(), np.zeros(6), np.full(7, np.nan)

    def process(
        self,
        report: np.ndarray,
        motors: np.ndarray,
        motor_angle: np.ndarray,
        planned_angle: np.ndarray,
        nominal: np.ndarray,
        correction: np.ndarray,
        reference: np.ndarray,
        holding: np.ndarray,
    ) -> None:
        """Hear, judge and answer, sample by sample."""
        for n in range(len(report)):
            self._done += 1
            if report[n, 0] > self._seen:
                self._seen = float(report[n, 0])
                self._hear(motors[n, 0] > 0.5, motor_angle[n], planned_angle[n])
                np.add(nominal[n], correction[n], out=self._corrected)
                self.conversation.wanted.put(nominal[n], self._corrected)
                answer = self.conversation.give()
                if answer is not None:
                    asked = unpack_command(answer).joint_angle
                    assert asked is not None  # the guard is one of joints
                    self._asked = asked
            self.conversation.watch(self.now)
            reference[n] = self._asked
            holding[n, 0] = self.conversation.state is not PortState.FOLLOWING

    @property
    def now(self) -> float:
        """The graph's time, s."""
        return self._done / self._rate

    @property
    def reason(self) -> str:
        """What has latched, or nothing."""
        return self.conversation.reason

    def start(self) -> None:
        """Let the robot follow, from where it is (between ticks); ValueError unless it is heard and nothing is latched.

        A limit that the first reference breaks latches as ever.
        """
        if self.reason or self.conversation.report is None:
            raise ValueError(f"the robot cannot start: {self.reason or 'it is silent'}")
        self.conversation.begin()

    def hold(self, reason: str) -> None:
        """Hold the robot for a reason from elsewhere; latches."""
        if self.conversation.state is PortState.FOLLOWING:
            self.conversation.latch(reason)

    def _hear(self, is_on: bool, motor_angle: np.ndarray, planned_angle: np.ndarray) -> None:
        counter = int(self._seen)
        motion = Motion.RUNNING if is_on else Motion.STOPPED
        told = Report(counter, counter / RATE, motor_angle, planned_angle, self._pose, is_on, is_on, motion)
        self.conversation.take(pack_report(told), _SENDER, self.now)
