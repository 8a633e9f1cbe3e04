"""The compiled kernel that looks at robot and force along the feed."""

import math

from numba import njit

from stagectl.robot.guard_kernel import flange

X, Y, REPORT, COUNT, CELLS = range(5)
"""Of `last`: m, m, the robot's count of reports, and samples since that rose."""


@njit(cache=True, nogil=True)
def run(report, motor_angle, force, direction, velocity, along, chain, tool, rate, pose, last):  # type: ignore[no-untyped-def]
    """Run one frame; signals as the ports of `FeedSeen`; `pose` (3, 4) is room."""
    for n in range(len(report)):
        x, y = direction[n, 0], direction[n, 1]
        along[n, 0] = -(force[n, 0] * x + force[n, 1] * y)
        along[n, 1] = force[n, 1] * x - force[n, 0] * y
        last[COUNT] += 1.0
        if report[n, 0] == last[REPORT]:
            velocity[n, 0] = math.nan
            continue
        flange(motor_angle[n], chain, tool, pose)
        if last[REPORT] > 0.0:
            way = (pose[0, 3] - last[X]) * x + (pose[1, 3] - last[Y]) * y
            velocity[n, 0] = way * rate / last[COUNT]
        else:
            velocity[n, 0] = 0.0
        last[X], last[Y], last[REPORT], last[COUNT] = pose[0, 3], pose[1, 3], report[n, 0], 0.0
