"""What force control is told of robot and force sensor: velocity along the feed, force against it and across."""

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.experiments.feed import feed_seen_kernel as kernel
from stagectl.robot.arm import Arm


class FeedSeen(Block):
    """Turn joint angles and a force into velocity and force of the feed.

    The velocity is that of the tool by the motors' angles, the mean since the report before; no number where there is
    no new report.

    Ports: `report` (1, how many the robot has sent), `motor_angle` (rad, 6), `force` (N, 3, on the tool in axes of the
    base), `direction` (1, 2, of the feed, along x and y) in; `velocity` (m/s), `along` (N, 2: against the feed, and
    across it to the left) out.

    Parameters
    ----------
    arm : Arm, of six joints
    tool : float, m, from the flange along its axis to the tool point
    """

    inputs = (Port("report"), Port("motor_angle", "rad", 6), Port("force", "N", 3), Port("direction", "1", 2))
    outputs = (Port("velocity", "m/s"), Port("along", "N", 2))

    def __init__(self, arm: Arm, tool: float) -> None:
        self._seen = np.zeros(1, kernel.SEEN)
        self._seen["chain"], self._seen["tool"] = np.stack([arm.offset, arm.d, arm.a, arm.alpha], axis=1), tool

    def prepare(self, rate: float, frames: int) -> None:
        """Have seen nothing."""
        self._seen["rate"] = rate
        for name in ("x", "y", "report", "count"):
            self._seen[name] = 0

    def process(
        self,
        report: np.ndarray,
        motor_angle: np.ndarray,
        force: np.ndarray,
        direction: np.ndarray,
        velocity: np.ndarray,
        along: np.ndarray,
    ) -> None:
        """Fill one frame."""
        kernel.run(report, motor_angle, force, direction, velocity, along, self._seen)
