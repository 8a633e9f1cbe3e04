"""The compiled kernel of an inverse kinematics that goes from sample to sample.

Numba's cache looks at the date of this file alone: touch it after a change of the kernels that it is made of.
"""

from numba import njit

from stagectl.robot.cartesian_kernel import correct
from stagectl.robot.guard_kernel import flange


@njit(cache=True, nogil=True)
def follow(place, joint_angle, origin, wanted, angle, chain, tool, length, least, work, pose, step):  # type: ignore[no-untyped-def]
    """Run one frame; `place` (frames, 3), m, `joint_angle` (frames, 6), rad.

    `wanted` (3, 3) is the tool's rotation, `angle` (6,) where the arm is; `step` (3, 6) is room; the others are those
    of `cartesian_kernel.correct`.
    """
    move, turn = step[0:1, :3], step[1:2, :3]
    for n in range(len(place)):
        flange(angle, chain, tool, pose)
        for r in range(3):
            i, j = (r + 1) % 3, (r + 2) % 3
            move[0, r] = place[n, r] + origin[r] - pose[r, 3]
            turn[0, r] = 0.0
            for c in range(3):
                turn[0, r] += 0.5 * (pose[i, c] * wanted[j, c] - pose[j, c] * wanted[i, c])
        correct(angle.reshape(1, 6), move, turn, step[2:3], chain, tool, length, least, work, pose)
        for joint in range(6):
            angle[joint] += step[2, joint]
            joint_angle[n, joint] = angle[joint]
