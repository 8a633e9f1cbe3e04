"""The compiled kernel of a stage on flexures: amplifiers, hysteresis, creep, modes, sensors."""

from typing import NamedTuple

import numpy as np
from numba import njit

from firmware_sim.plants.flush_kernel import flushed
from firmware_sim.plants.hysteresis_kernel import (
    BOUC_WEN,
    COULOMB,
    MAXWELL_SLIP,
    PLAYS,
    SLOPE,
    bouc_wen,
    bristles,
    charge,
    plays,
)
from firmware_sim.plants.noise_kernel import NOISE_SCALE, four_uniforms

LOW, RANGE, AMPLIFIER, LAG, LAG_NOW, SLEW, KIND, CURVE, AT_ONCE, STROKE, RESIDUAL, STEP, AXIS = range(13)
"""Of an axis: V, V, poles of amplifier and lag, what the lag takes of the newest, V a sample, kind, 1, creep that comes
at once, m, what of the expansion shows on the gauge beside the modes, s."""
RMS, RESOLUTION, BOTTOM, TOP, GAIN, FILTER, NOW, SENSOR = range(8)
"""Of a sensor: m rms, m, m, m, 1, the pole of each of its two low-passes, and what they take of the newest."""
ASKED, LAGGED, USED, STATE, EXPANDED, MEMORY = range(6)
"""Of an axis' `memory`: V behind amplifier and lag, the voltage as part of its range, h or charge, m."""
CYCLES, PHASE, LASER = range(3)
"""Of `laser`: its cycles a sample, and where it is between two."""


class Stage(NamedTuple):
    """All arrays of a stage.

    `axes` (3, AXIS), columns as above; `hysteresis` (3, 5), `threshold`, `weight` (3, elements), their numbers;
    `guides` (3, GUIDE), no guide where COULOMB is 0; `creep` (3, 2, terms), parts of a sample and shares; `table` (17,
    modes): q' = a q + b v + e F, v' = c q + d v + b F as a b c d e, what stacks and forces do to the modes, what those
    do to stacks and plate; `sensors` (3, 3, SENSOR) of gauge, plate and laser, each axis.  State: `memory` (3, MEMORY),
    `elements` (3, elements), `bristle` (3,), `crept` (3, terms), `motion` (2, modes), `filters` (3, 3, 3), `line`
    (delay + 1, 6), `late` (laser's delay + 1, 3), `ends` (2,), where both are written, `laser` (LASER,), `shown` (3,),
    `random` (1,).
    """

    axes: np.ndarray
    hysteresis: np.ndarray
    threshold: np.ndarray
    weight: np.ndarray
    guides: np.ndarray
    creep: np.ndarray
    table: np.ndarray
    sensors: np.ndarray
    memory: np.ndarray
    elements: np.ndarray
    bristle: np.ndarray
    crept: np.ndarray
    motion: np.ndarray
    filters: np.ndarray
    line: np.ndarray
    late: np.ndarray
    ends: np.ndarray
    laser: np.ndarray
    shown: np.ndarray
    random: np.ndarray


@njit(cache=True, nogil=True, inline="always")
def low_passed(state: float, before: float, now: float, pole: float, newest: float) -> float:
    """Return a first-order low-pass' state after a sample in which its input went straight from `before` to `now`."""
    return flushed(pole * state + (1.0 - pole - newest) * before + newest * now)


@njit(cache=True, nogil=True)
def expand(axis: int, voltage: float, stage: Stage) -> float:
    """Return a stack's free expansion, m, halfway through a sample over which `voltage` (V) is asked for."""
    given, memory = stage.axes[axis], stage.memory[axis]
    asked = min(max(voltage - given[LOW], 0.0), given[RANGE])
    step = min(max((1.0 - given[AMPLIFIER]) * (asked - memory[ASKED]), -given[SLEW]), given[SLEW])
    amplified = flushed(memory[ASKED] + step)
    memory[LAGGED] = low_passed(memory[LAGGED], memory[ASKED], amplified, given[LAG], given[LAG_NOW])
    memory[ASKED] = amplified
    before, now = memory[USED], memory[LAGGED] / given[RANGE]
    memory[USED] = now
    elements, numbers = stage.elements[axis], stage.hysteresis[axis]
    fast = numbers[SLOPE] * now
    if given[KIND] == BOUC_WEN:
        memory[STATE] = bouc_wen(before, now, memory[STATE], numbers)
        fast -= memory[STATE]
    elif given[KIND] == PLAYS:
        fast += plays(now, elements, stage.threshold[axis], stage.weight[axis])
    elif given[KIND] == MAXWELL_SLIP:
        limit, stiff = stage.threshold[axis], stage.weight[axis]
        memory[STATE] = charge(before, now, memory[STATE], elements, limit, stiff, numbers)
        fast = numbers[SLOPE] * memory[STATE]
    fast += 4.0 * given[CURVE] * fast * (1.0 - fast)
    crept, creep = stage.crept[axis], stage.creep[axis]
    total = (1.0 + given[AT_ONCE]) * fast
    for i in range(crept.shape[0]):
        crept[i] = flushed(crept[i] + creep[0, i] * (fast - crept[i]))
        total += creep[1, i] * crept[i]
    before, memory[EXPANDED] = memory[EXPANDED], given[STROKE] * total
    return float(0.5 * (before + memory[EXPANDED]))


@njit(cache=True, nogil=True)
def _move(expansion: np.ndarray, force: np.ndarray, motion: np.ndarray, table: np.ndarray) -> None:
    """Go on by one sample under free expansions (3,), m, and forces (3,), N, held over it."""
    for m in range(motion.shape[1]):
        drive = table[5, m] * expansion[0] + table[6, m] * expansion[1] + table[7, m] * expansion[2]
        drive += table[8, m] * force[0] + table[9, m] * force[1] + table[10, m] * force[2]
        position, velocity = motion[0, m], motion[1, m]
        motion[0, m] = flushed(table[0, m] * position + table[1, m] * velocity + table[4, m] * drive)
        motion[1, m] = flushed(table[2, m] * position + table[3, m] * velocity + table[1, m] * drive)


@njit(cache=True, nogil=True)
def _push(given: np.ndarray, stage: Stage, force: np.ndarray) -> None:
    """Fill `force` (3,), N, on the plate: what is `given`, less the friction of its guides."""
    for axis in range(3):
        force[axis] = given[axis]
        numbers = stage.guides[axis]
        if numbers[COULOMB] == 0.0:
            continue
        speed = 0.0
        for m in range(stage.motion.shape[1]):
            speed += stage.table[14 + axis, m] * stage.motion[1, m]
        drag, stage.bristle[axis] = bristles(speed, stage.axes[axis, STEP], stage.bristle[axis], numbers)
        force[axis] -= drag


@njit(cache=True, nogil=True)
def _filtered(sensor: int, axis: int, value: float, stage: Stage) -> float:
    """Return what a sensor's two low-passes make of a value, m."""
    states, given = stage.filters[sensor, axis], stage.sensors[sensor, axis]
    first = low_passed(states[1], states[0], value, given[FILTER], given[NOW])
    states[2] = low_passed(states[2], states[1], first, given[FILTER], given[NOW])
    states[0], states[1] = value, first
    return float(states[2])


@njit(cache=True, nogil=True)
def _read(sensor: int, axis: int, value: float, stage: Stage) -> float:
    """Return what a sensor shows of a value, m: its gain, noise, range and steps."""
    given = stage.sensors[sensor, axis]
    noisy = given[GAIN] * value + given[RMS] * NOISE_SCALE * four_uniforms(stage.random)
    return float(given[RESOLUTION] * np.rint(min(max(noisy, given[BOTTOM]), given[TOP]) / given[RESOLUTION]))


@njit(cache=True, nogil=True)
def run(
    voltage: np.ndarray,
    force: np.ndarray,
    base: np.ndarray,
    extension: np.ndarray,
    position: np.ndarray,
    absolute: np.ndarray,
    stage: Stage,
) -> None:
    """Run one frame: `voltage` (V), `force` (N), `base` (m) in, the others (m) out, (frames, 3) each."""
    expansion, pushed = np.empty(3), np.empty(3)
    at, later = stage.ends[0], stage.ends[1]
    for n in range(voltage.shape[0]):
        for axis in range(3):
            expansion[axis] = expand(axis, voltage[n, axis], stage)
        _push(force[n], stage, pushed)
        _move(expansion, pushed, stage.motion, stage.table)
        for axis in range(3):
            stack = stage.axes[axis, RESIDUAL] * stage.memory[axis, EXPANDED]
            plate = 0.0
            for m in range(stage.motion.shape[1]):
                stack += stage.table[11 + axis, m] * stage.motion[0, m]
                plate += stage.table[14 + axis, m] * stage.motion[0, m]
            stage.line[at, axis] = _filtered(0, axis, stack, stage)
            stage.line[at, 3 + axis] = _filtered(1, axis, plate, stage)
            stage.late[later, axis] = _filtered(2, axis, plate + base[n, axis], stage)
        at = at + 1 if at + 1 < stage.line.shape[0] else 0
        later = later + 1 if later + 1 < stage.late.shape[0] else 0
        stage.laser[PHASE] += stage.laser[CYCLES]
        fires = stage.laser[PHASE] >= 1.0
        stage.laser[PHASE] -= 1.0 if fires else 0.0
        for axis in range(3):  # the oldest is shown
            extension[n, axis] = _read(0, axis, stage.line[at, axis], stage)
            position[n, axis] = _read(1, axis, stage.line[at, 3 + axis], stage)
            if fires:
                stage.shown[axis] = _read(2, axis, stage.late[later, axis], stage)
            absolute[n, axis] = stage.shown[axis]
    stage.ends[0], stage.ends[1] = at, later
