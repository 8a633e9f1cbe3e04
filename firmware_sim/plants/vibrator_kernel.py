"""The vibrator sample by sample: exact modal recursion, with the nonlinear forces taken at the sample's start."""

import numpy as np
from numba import njit

# Rows of `recursion` (6, modes): q' = a q + b v + e F, v' = c q + d v + g F.  Rows of `shapes` (10, modes): coil 1, 2;
# spring 1, 2; joint 1, 2; the shells' w^2 (1, 2) and 2 zeta w (1, 2).  `constants` are named in vibrator.py.


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract", "nsz"})
def run_modes(
    drive: np.ndarray,
    response: np.ndarray,
    motion: np.ndarray,
    memory: np.ndarray,
    recursion: np.ndarray,
    shapes: np.ndarray,
    direct: np.ndarray,
    constants: np.ndarray,
) -> None:
    """Fill `response` (frames, 2) m/s^2 from `drive` (frames, 2) V.

    `motion` (2, modes) holds q and dq/dt; `memory` (6,) the coil currents and the slips of spring and joint friction.
    `direct` (2, 6) is each shell's acceleration per force: coils, springs, joints.
    """
    q, v = motion[0], motion[1]
    # taken row by row: numba keeps an indexed row contiguous, an unpacked one not, and then the loops stay scalar
    coil1, coil2, spring1, spring2, joint1, joint2 = shapes[0], shapes[1], shapes[2], shapes[3], shapes[4], shapes[5]
    stiff1, stiff2, damp1, damp2 = shapes[6], shapes[7], shapes[8], shapes[9]
    q_q, q_v, v_q, v_v = recursion[0], recursion[1], recursion[2], recursion[3]
    q_force, v_force = recursion[4], recursion[5]
    decay, back_emf, step, clip = constants[0], constants[1], constants[2], constants[3]
    motor, offset, reach = constants[4], constants[5], constants[6]
    cubic, sag, stop, gap = constants[7], constants[8], constants[9], constants[10]
    friction, slip, joint_friction, joint_slip = constants[11], constants[12], constants[13], constants[14]
    peak_motor = motor * (1 + (offset / reach) ** 2)
    for n in range(drive.shape[0]):
        x1 = x2 = u1 = u2 = s1 = s2 = r1 = r2 = w1 = w2 = a1 = a2 = 0.0
        for m in range(q.shape[0]):
            x1 += coil1[m] * q[m]
            x2 += coil2[m] * q[m]
            u1 += coil1[m] * v[m]
            u2 += coil2[m] * v[m]
            s1 += spring1[m] * q[m]
            s2 += spring2[m] * q[m]
            r1 += spring1[m] * v[m]
            r2 += spring2[m] * v[m]
            w1 += joint1[m] * v[m]
            w2 += joint2[m] * v[m]
            a1 -= stiff1[m] * q[m] + damp1[m] * v[m]
            a2 -= stiff2[m] * q[m] + damp2[m] * v[m]
        # coil: force factor BL(x), current behind resistance and inductance, back-EMF
        b1 = peak_motor / (1 + ((x1 - offset) / reach) ** 2)
        b2 = peak_motor / (1 + ((x2 - offset) / reach) ** 2)
        c1, c2 = b1 * memory[0], b2 * memory[1]
        memory[0] = decay * memory[0] + (1 - decay) * (min(max(drive[n, 0], -clip), clip) - back_emf * b1 * u1)
        memory[1] = decay * memory[1] + (1 - decay) * (min(max(drive[n, 1], -clip), clip) - back_emf * b2 * u2)
        # spring element: stiffening about its sag, a soft stop on one side, friction; then the bolted joints
        f1 = cubic * s1 * s1 * (s1 + 3 * sag) + stop * max(s1 - gap, 0.0) + friction * memory[2]
        f2 = cubic * s2 * s2 * (s2 + 3 * sag) + stop * max(s2 - gap, 0.0) + friction * memory[3]
        h1, h2 = joint_friction * memory[4], joint_friction * memory[5]
        memory[2] = (memory[2] + step * r1 / slip) / (1 + step * abs(r1) / slip)
        memory[3] = (memory[3] + step * r2 / slip) / (1 + step * abs(r2) / slip)
        memory[4] = (memory[4] + step * w1 / joint_slip) / (1 + step * abs(w1) / joint_slip)
        memory[5] = (memory[5] + step * w2 / joint_slip) / (1 + step * abs(w2) / joint_slip)
        response[n, 0] = (
            a1
            + direct[0, 0] * c1
            + direct[0, 1] * c2
            - (direct[0, 2] * f1 + direct[0, 3] * f2 + direct[0, 4] * h1 + direct[0, 5] * h2)
        )
        response[n, 1] = (
            a2
            + direct[1, 0] * c1
            + direct[1, 1] * c2
            - (direct[1, 2] * f1 + direct[1, 3] * f2 + direct[1, 4] * h1 + direct[1, 5] * h2)
        )
        for m in range(q.shape[0]):
            force = coil1[m] * c1 + coil2[m] * c2
            force -= spring1[m] * f1 + spring2[m] * f2 + joint1[m] * h1 + joint2[m] * h2
            position, velocity = q[m], v[m]
            q[m] = q_q[m] * position + q_v[m] * velocity + q_force[m] * force
            v[m] = v_q[m] * position + v_v[m] * velocity + v_force[m] * force


@njit(cache=True, nogil=True)
def retune(
    frequency: np.ndarray,
    damping: np.ndarray,
    shell: np.ndarray,
    step: float,
    recursion: np.ndarray,
    shapes: np.ndarray,
) -> None:
    """Compute the exact recursion of modes at `frequency` (modes,) Hz for a force held over `step` s, in place."""
    for m in range(frequency.shape[0]):
        omega = 2 * np.pi * frequency[m]
        sigma = damping[m] * omega
        ringing = omega * np.sqrt(1 - damping[m] ** 2)
        shrink, cosine, sine = np.exp(-sigma * step), np.cos(ringing * step), np.sin(ringing * step)
        recursion[0, m] = shrink * (cosine + sigma / ringing * sine)
        recursion[1, m] = shrink * sine / ringing
        recursion[2, m] = -omega * omega * recursion[1, m]
        recursion[3, m] = shrink * (cosine - sigma / ringing * sine)
        recursion[4, m] = (1 - recursion[0, m]) / omega**2
        recursion[5, m] = recursion[1, m]
        for side in range(2):
            shapes[6 + side, m] = shell[side, m] * omega**2
            shapes[8 + side, m] = shell[side, m] * 2 * sigma


@njit(cache=True, nogil=True)
def add_pickup(response: np.ndarray, noise: np.ndarray, rms: float, hum: float, cycles: float, first: int) -> None:
    """Add sensor noise of `rms` m/s^2 and mains hum: `hum` m/s^2 at `cycles` per sample, a tenth of it at the third."""
    for n in range(response.shape[0]):
        sine = np.sin(2 * np.pi * ((cycles * (first + n)) % 1.0))
        mains = hum * (sine + 0.1 * (3 * sine - 4 * sine**3))
        for side in range(response.shape[1]):
            response[n, side] += rms * noise[n, side] + mains
