"""The vibrator sample by sample: exact modal recursion, with the nonlinear forces taken at the sample's start."""

import numpy as np

from firmware_sim.plants.flush_kernel import flushed
from rigkit.compiled import njit

# Rows of `recursion` (6, modes): q' = a q + b v + e F, v' = c q + d v + g F.  Rows of `shapes` (10, modes), each for
# side 1 and side 2: coil, spring, joint, the shell's w^2 and 2 zeta w.  `constants` are named in vibrator.py.  The
# loops over the modes stand here, with rows taken one by one: only so does LLVM keep them vectorised.

FAST = {"reassoc", "contract", "nsz"}


@njit(cache=True, nogil=True, fastmath=FAST)
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
    coil1, coil2, spring1, spring2, joint1, joint2 = shapes[0], shapes[1], shapes[2], shapes[3], shapes[4], shapes[5]
    stiff1, stiff2, damp1, damp2 = shapes[6], shapes[7], shapes[8], shapes[9]
    q_q, q_v, v_q, v_v = recursion[0], recursion[1], recursion[2], recursion[3]
    q_force, v_force = recursion[4], recursion[5]
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
        c1, f1, h1 = _forces(0, drive[n, 0], (x1, u1, s1, r1, w1), memory, constants)
        c2, f2, h2 = _forces(1, drive[n, 1], (x2, u2, s2, r2, w2), memory, constants)
        response[n, 0] = a1 + _accelerated(direct[0], c1, c2, f1, f2, h1, h2)
        response[n, 1] = a2 + _accelerated(direct[1], c1, c2, f1, f2, h1, h2)
        for m in range(q.shape[0]):
            force = coil1[m] * c1 + coil2[m] * c2
            force -= spring1[m] * f1 + spring2[m] * f2 + joint1[m] * h1 + joint2[m] * h2
            position, velocity = q[m], v[m]
            q[m] = flushed(q_q[m] * position + q_v[m] * velocity + q_force[m] * force)
            v[m] = flushed(v_q[m] * position + v_v[m] * velocity + v_force[m] * force)


@njit(cache=True, nogil=True, fastmath=FAST)
def _forces(
    side: int, drive: float, motion: tuple[float, ...], memory: np.ndarray, constants: np.ndarray
) -> tuple[float, float, float]:
    """Return the forces of a side's coil, spring element and joints, N, and move its current and slips on.

    `motion` is the coil's place (m) and velocity, the spring's elongation (m) and its rate, and the joints' (m/s).
    """
    coil, coil_rate, longer, rate, sliding = motion
    decay, back_emf, step, clip = constants[0], constants[1], constants[2], constants[3]
    motor, offset, reach = constants[4], constants[5], constants[6]
    cubic, sag, stop, gap = constants[7], constants[8], constants[9], constants[10]
    friction, slip, joint_friction, joint_slip = constants[11], constants[12], constants[13], constants[14]
    # coil: force factor BL(x), current behind resistance and inductance, back-EMF
    factor = motor * (1 + (offset / reach) ** 2) / (1 + ((coil - offset) / reach) ** 2)
    pull = factor * memory[side]
    voltage = min(max(drive, -clip), clip) - back_emf * factor * coil_rate
    memory[side] = flushed(decay * memory[side] + (1 - decay) * voltage)
    # spring element: stiffening about its sag, a soft stop on one side, friction; then the bolted joints
    spring = cubic * longer * longer * (longer + 3 * sag) + stop * max(longer - gap, 0.0) + friction * memory[2 + side]
    joint = joint_friction * memory[4 + side]
    travel, slide = step * rate / slip, step * sliding / joint_slip
    memory[2 + side] = flushed((memory[2 + side] + travel) / (1 + abs(travel)))
    memory[4 + side] = flushed((memory[4 + side] + slide) / (1 + abs(slide)))
    return pull, spring, joint


@njit(cache=True, nogil=True, fastmath=FAST)
def _accelerated(direct: np.ndarray, c1: float, c2: float, f1: float, f2: float, h1: float, h2: float) -> float:
    """Return what the forces do at once to a shell, m/s^2."""
    driven: float = direct[0] * c1 + direct[1] * c2
    driven -= direct[2] * f1 + direct[3] * f2 + direct[4] * h1 + direct[5] * h2
    return driven


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
