"""A frame of samples of the simulated robot: references in between, sensors at each sample's end."""

import numpy as np

from firmware_sim.plants.noise_kernel import NOISE_SCALE, four_uniforms
from firmware_sim.plants.robot_geometry_kernel import place
from firmware_sim.plants.robot_joint_kernel import LINK, MOTOR
from firmware_sim.plants.robot_kernel import PHASE, REFRESH, Parts, advance, bear, refresh
from rigkit.compiled import njit

ARM = np.dtype(
    [
        ("steps", "i8"),  # a sample
        ("tool", "f8"),  # m
        ("angle_noise", "f8", 6),  # rad rms
        ("torque_noise", "f8", 6),  # N m rms
        ("last", "f8", 6),  # rad, the reference before
        ("held", "f8", 6),  # N m, the torque in effect
    ],
    align=True,
)


@njit(cache=True, nogil=True)
def run_arm(
    reference: np.ndarray,
    wrench: np.ndarray,
    told: tuple[np.ndarray, ...],
    parts: Parts,
    shown: np.ndarray,
    arms: np.ndarray,
    random: np.ndarray,
) -> None:
    """Fill `told` from `reference` (rad) and `wrench` (N and N m, base axes, at the tool), (frames, 6) each.

    `told` is angle of the motors, torque, angle of the links, and pose; `shown` (8, 3, 4) gets the frames at the end,
    tilted by what is soft across the axes; `arms` is of one `ARM`.
    """
    (motor_angle, torque, link_angle, pose), arm = told, arms[0]
    last, held, wanted, steps, tool = arm.last, arm.held, np.empty(6), arm.steps, arm.tool
    switches = parts.switches
    for n in range(reference.shape[0]):
        for k in range(steps):
            if switches[PHASE] == 0.0:
                refresh(wrench[n], tool, parts)
            elif k == 0:
                bear(wrench[n], parts)
            for i in range(6):
                wanted[i] = last[i] + (reference[n, i] - last[i]) * (k + 1) / steps
            advance(wanted, held, parts)
            switches[PHASE] = (switches[PHASE] + 1.0) % switches[REFRESH]
        for i in range(6):
            last[i] = reference[n, i]
            motor_angle[n, i] = parts.state[MOTOR, i] + arm.angle_noise[i] * gauss(random)
            torque[n, i] = held[i] + arm.torque_noise[i] * gauss(random)
            link_angle[n, i] = parts.state[LINK, i]
        place(parts.state[LINK], parts.tilt, parts.links, tool, shown)
        write_pose(shown[7], pose[n])


@njit(cache=True, nogil=True)
def write_pose(frame: np.ndarray, pose: np.ndarray) -> None:
    """Fill `pose` (7,) from a frame (3, 4): position (m), then the unit quaternion w x y z with w >= 0."""
    for r in range(3):
        pose[r] = frame[r, 3]
    trace = frame[0, 0] + frame[1, 1] + frame[2, 2]
    largest = 0
    for r in range(1, 3):
        if frame[r, r] > frame[largest, largest]:
            largest = r
    if trace > frame[largest, largest]:
        pose[3] = 1.0 + trace
        pose[4] = frame[2, 1] - frame[1, 2]
        pose[5] = frame[0, 2] - frame[2, 0]
        pose[6] = frame[1, 0] - frame[0, 1]
    else:
        i, j, k = largest, (largest + 1) % 3, (largest + 2) % 3
        pose[3] = frame[k, j] - frame[j, k]
        pose[4 + i] = 1.0 + frame[i, i] - frame[j, j] - frame[k, k]
        pose[4 + j] = frame[j, i] + frame[i, j]
        pose[4 + k] = frame[k, i] + frame[i, k]
    length = np.sqrt(pose[3] ** 2 + pose[4] ** 2 + pose[5] ** 2 + pose[6] ** 2)
    sign = -1.0 if pose[3] < 0.0 else 1.0
    for r in range(3, 7):
        pose[r] *= sign / length


@njit(cache=True, nogil=True)
def gauss(random: np.ndarray) -> float:
    """Return the next of nearly normal numbers of unit variance; `random` (1,) is their state."""
    return float(NOISE_SCALE * four_uniforms(random))
