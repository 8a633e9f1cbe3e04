"""The compiled kernel of an inverse kinematics that goes from sample to sample."""

import numpy as np

from rigkit.compiled import njit
from stagectl.robot.cartesian_kernel import correct
from stagectl.robot.guard_kernel import flange

WAY = np.dtype(
    [
        ("origin", "f8", 3),  # m, of places, base axes
        ("wanted", "f8", (3, 3)),  # the tool's rotation
        ("angle", "f8", 6),  # rad, where the arm is
        ("step", "f8", (3, 6)),  # room
    ],
    align=True,
)


@njit(cache=True, nogil=True)
def follow(place: np.ndarray, joint_angle: np.ndarray, ways: np.ndarray, arms: np.ndarray) -> None:
    """Run one frame; `place` (frames, 3), m, `joint_angle` (frames, 6), rad.

    `ways` is of one `WAY`, `arms` of one `TOOL_ARM`.
    """
    way, arm = ways[0], arms[0]
    origin, wanted, pose, angle, step = way.origin, way.wanted, arm.pose, way.angle, way.step
    move, turn = step[0:1, :3], step[1:2, :3]
    for n in range(len(place)):
        flange(angle, arm.chain, arm.tool, pose)
        for r in range(3):
            i, j = (r + 1) % 3, (r + 2) % 3
            move[0, r] = place[n, r] + origin[r] - pose[r, 3]
            turn[0, r] = 0.0
            for c in range(3):
                turn[0, r] += 0.5 * (pose[i, c] * wanted[j, c] - pose[j, c] * wanted[i, c])
        correct(angle.reshape(1, 6), move, turn, step[2:3], arms)
        for joint in range(6):
            angle[joint] += step[2, joint]
            joint_angle[n, joint] = angle[joint]
