"""The piezo stage sample by sample: amplifiers, stacks with loops and creep, exact modal recursion, sensors."""

import numpy as np

from firmware_sim.plants.flush_kernel import flushed
from firmware_sim.plants.noise_kernel import NOISE_SCALE, four_uniforms
from firmware_sim.plants.piezo_stage_actuator import CONSTANTS, CREEP_TIMES, PLAYS, VOLTAGE
from firmware_sim.plants.record import Record
from rigkit.compiled import njit

# Rows of `actuators`: piezo_stage_actuator.py.  Rows of `stacks` (3, 1 + PLAYS + creep): the amplifier's output, the
# plays, the creep.  Rows of `mechanics` (17, modes): q' = a q + b v + e F, v' = c q + d v + b F as a b c d e; what
# stacks and process forces do to the modes; what the modes do to stacks and plate, x y z each.  `line` (delay + 1, 6):
# what the sensors are still to show.  Loops over modes and plays are kept simple, with one store each: only so does
# LLVM vectorise them.

CREEPS = len(CREEP_TIMES)
CONVERTER_STEPS = 65_536
FAST = {"reassoc", "contract", "nsz"}

SENSOR = np.dtype([("rms", "f8"), ("step", "f8"), ("bottom", "f8"), ("top", "f8")], align=True)
"""m: noise, grid and range."""
SHOWN = np.dtype(
    [
        ("gauge", SENSOR),
        ("plate", SENSOR),
        ("laser", SENSOR),
        ("gain", "f8", 3),  # of the gauges
        ("cycles", "f8"),  # of the laser, a sample
        # state
        ("phase", "f8"),  # of the laser, cycles
        ("held", "f8", 3),  # m, what it shows
        ("seen", "f8", 3),  # m, what it will show
        ("at", "i8"),  # where `line` is written
    ],
    align=True,
)


@njit(cache=True, nogil=True, fastmath=FAST)
def run_stage(
    signals: tuple[np.ndarray, ...],
    motion: np.ndarray,
    stacks: np.ndarray,
    line: np.ndarray,
    actuators: np.ndarray,
    mechanics: np.ndarray,
    showing: np.ndarray,
    random: np.ndarray,
) -> None:
    """Run one frame: `signals` are voltage (V), force (N), base (m) in, extension, position, absolute (m) out.

    They are (frames, 3) each; `showing` is of one `SHOWN`, `random` (1,) the noise's state.
    """
    voltage, force, base, extension, position, absolute = signals
    shown = showing[0]
    at = shown.at
    for n in range(voltage.shape[0]):
        h0 = expand(0, voltage[n, 0], stacks, actuators)
        h1 = expand(1, voltage[n, 1], stacks, actuators)
        h2 = expand(2, voltage[n, 2], stacks, actuators)
        _move(h0, h1, h2, force[n, 0], force[n, 1], force[n, 2], motion, mechanics)
        _observe(motion, mechanics, at, line)
        at = at + 1 if at + 1 < line.shape[0] else 0
        shown.phase += shown.cycles
        fires = shown.phase >= 1.0
        for axis in range(3):
            plate = line[at, 3 + axis]  # the oldest
            extension[n, axis] = _read(shown.gauge, shown.gain[axis] * line[at, axis], random)
            position[n, axis] = _read(shown.plate, plate, random)
            if fires:
                shown.held[axis] = shown.seen[axis]
                shown.seen[axis] = _read(shown.laser, plate + base[n, axis], random)
            absolute[n, axis] = shown.held[axis]
        if fires:
            shown.phase -= 1.0
    shown.at = at


@njit(cache=True, nogil=True, fastmath=FAST)
def expand(axis: int, voltage: float, stacks: np.ndarray, actuators: np.ndarray) -> float:
    """Return the free expansion of a stack, m, at the end of a sample over which `voltage` is asked for."""
    step = VOLTAGE / (CONVERTER_STEPS - 1)
    asked = step * np.rint(min(max(voltage, 0.0), VOLTAGE) * (1.0 / step))
    slew = actuators[axis, 4]
    before = stacks[axis, 0]
    stacks[axis, 0] = flushed(before + min(max((1.0 - actuators[axis, 3]) * (asked - before), -slew), slew))
    u = stacks[axis, 0] * (1.0 / VOLTAGE)
    u += 4.0 * actuators[axis, 1] * u * (1.0 - u)
    fast = actuators[axis, 2] * u
    for i in range(PLAYS):
        # a play whose excess over its threshold decays instead of vanishing
        excess = u - stacks[axis, 1 + i]
        threshold = actuators[axis, CONSTANTS + i]
        beyond = max(excess - threshold, 0.0) + min(excess + threshold, 0.0)
        moved = flushed(stacks[axis, 1 + i] + actuators[axis, CONSTANTS + 2 * PLAYS + i] * beyond)
        stacks[axis, 1 + i] = moved
        fast += actuators[axis, CONSTANTS + PLAYS + i] * moved
    total = fast
    for i in range(CREEPS):
        crept = stacks[axis, 1 + PLAYS + i]
        crept = flushed(crept + (1.0 - actuators[axis, CONSTANTS + 3 * PLAYS + i]) * (fast - crept))
        stacks[axis, 1 + PLAYS + i] = crept
        total += actuators[axis, CONSTANTS + 3 * PLAYS + CREEPS + i] * crept
    expansion: float = actuators[axis, 0] * total
    return expansion


@njit(cache=True, nogil=True, fastmath=FAST)
def _move(
    h0: float, h1: float, h2: float, f0: float, f1: float, f2: float, motion: np.ndarray, table: np.ndarray
) -> None:
    """Go on by one sample under free expansions (m) and forces (N) held over it."""
    for m in range(motion.shape[1]):
        drive = table[5, m] * h0 + table[6, m] * h1 + table[7, m] * h2
        drive += table[8, m] * f0 + table[9, m] * f1 + table[10, m] * f2
        position, velocity = motion[0, m], motion[1, m]
        motion[0, m] = flushed(table[0, m] * position + table[1, m] * velocity + table[4, m] * drive)
        motion[1, m] = flushed(table[2, m] * position + table[3, m] * velocity + table[1, m] * drive)


@njit(cache=True, nogil=True, fastmath=FAST)
def _observe(motion: np.ndarray, table: np.ndarray, at: int, line: np.ndarray) -> None:
    """Note stacks and plate, m."""
    e0 = e1 = e2 = p0 = p1 = p2 = 0.0
    for m in range(motion.shape[1]):
        e0 += table[11, m] * motion[0, m]
        e1 += table[12, m] * motion[0, m]
        e2 += table[13, m] * motion[0, m]
        p0 += table[14, m] * motion[0, m]
        p1 += table[15, m] * motion[0, m]
        p2 += table[16, m] * motion[0, m]
    line[at, 0], line[at, 1], line[at, 2] = e0, e1, e2
    line[at, 3], line[at, 4], line[at, 5] = p0, p1, p2


@njit(cache=True, nogil=True, fastmath=FAST)
def _read(sensor: Record, value: float, random: np.ndarray) -> float:
    """Return what a sensor makes of a value, m: with noise, within its range, on its converter's grid."""
    noisy = value + sensor.rms * NOISE_SCALE * four_uniforms(random)
    return float(sensor.step * np.rint(min(max(noisy, sensor.bottom), sensor.top) / sensor.step))
