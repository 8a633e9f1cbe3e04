"""The compiled kernel that looks at robot and force along the feed."""

import math

import numpy as np

from rigkit.compiled import njit
from stagectl.robot.guard_kernel import flange

SEEN = np.dtype(
    [
        ("chain", "f8", (6, 4)),  # of `guard_kernel.flange`
        ("tool", "f8"),  # m, from the flange to the tool point
        ("rate", "f8"),  # samples/s
        # at the last report
        ("x", "f8"),  # m
        ("y", "f8"),  # m
        ("report", "f8"),  # the robot's count of them
        ("count", "i8"),  # samples since that rose
        ("pose", "f8", (3, 4)),  # room
    ],
    align=True,
)


@njit(cache=True, nogil=True)
def run(
    report: np.ndarray,
    motor_angle: np.ndarray,
    force: np.ndarray,
    direction: np.ndarray,
    velocity: np.ndarray,
    along: np.ndarray,
    memory: np.ndarray,
) -> None:
    """Run one frame; signals as the ports of `FeedSeen`; `memory` is of one `SEEN`."""
    last = memory[0]
    pose = last.pose
    for n in range(len(report)):
        x, y = direction[n, 0], direction[n, 1]
        along[n, 0] = -(force[n, 0] * x + force[n, 1] * y)
        along[n, 1] = force[n, 1] * x - force[n, 0] * y
        last.count += 1
        if report[n, 0] == last.report:
            velocity[n, 0] = math.nan
            continue
        flange(motor_angle[n], last.chain, last.tool, pose)
        if last.report > 0.0:
            way = (pose[0, 3] - last.x) * x + (pose[1, 3] - last.y) * y
            velocity[n, 0] = way * last.rate / last.count
        else:
            velocity[n, 0] = 0.0
        last.x, last.y, last.report, last.count = pose[0, 3], pose[1, 3], report[n, 0], 0
