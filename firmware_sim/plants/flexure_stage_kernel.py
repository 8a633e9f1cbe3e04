"""The compiled kernel of a stage on flexures: amplifiers, hysteresis, creep, modes, sensors."""

from typing import NamedTuple

import numpy as np

from firmware_sim.plants.flush_kernel import flushed
from firmware_sim.plants.hysteresis_kernel import (
    BOUC_WEN,
    COULOMB,
    GUIDE,
    MAXWELL_SLIP,
    PLAYS,
    SLOPE,
    bouc_wen,
    bristles,
    charge,
    plays,
)
from firmware_sim.plants.noise_kernel import NOISE_SCALE, four_uniforms
from rigkit.compiled import njit

AXIS = np.dtype(
    [
        ("low", "f8"),  # V
        ("reach", "f8"),  # V, from there to the highest
        ("amplifier", "f8"),  # its pole
        ("lag", "f8"),  # its pole
        ("lag_now", "f8"),  # what it takes of the newest
        ("slew", "f8"),  # V a sample
        ("kind", "i8"),  # of hysteresis
        ("curve", "f8"),  # 1
        ("at_once", "f8"),  # creep that comes at once, 1
        ("stroke", "f8"),  # m
        ("residual", "f8"),  # what of the expansion shows on the gauge beside the modes
        ("step", "f8"),  # s
        ("hysteresis", "f8", 5),  # numbers of its law
        ("guide", "f8", GUIDE),  # no guide where COULOMB is 0
        # state
        ("asked", "f8"),  # V behind the amplifier
        ("lagged", "f8"),  # V behind the lag
        ("used", "f8"),  # that as part of its range
        ("state", "f8"),  # h or charge
        ("expanded", "f8"),  # m
        ("bristle", "f8"),  # m, of the guide
        ("shown", "f8"),  # m, by the laser
    ],
    align=True,
)
SENSOR = np.dtype(
    [
        # m
        ("rms", "f8"),
        ("resolution", "f8"),
        ("bottom", "f8"),
        ("top", "f8"),
        ("gain", "f8"),  # 1
        ("filter", "f8"),  # the pole of each of its two low-passes
        ("now", "f8"),  # what they take of the newest
        ("states", "f8", 3),  # m, of the low-passes
    ],
    align=True,
)
LINES = np.dtype([("at", "i8"), ("later", "i8"), ("cycles", "f8"), ("phase", "f8")], align=True)
"""Where both lines are written; the laser's cycles a sample, and where it is between two."""


class Stage(NamedTuple):
    """All arrays of a stage.

    `axes` (3,) of `AXIS`; `threshold`, `weight` (3, elements), numbers of their hysteresis; `creep` (3, 2, terms),
    parts of a sample and shares; `table` (17, modes): q' = a q + b v + e F, v' = c q + d v + b F as a b c d e, what
    stacks and forces do to the modes, what those do to stacks and plate; `sensors` (3, 3) of `SENSOR`: gauge, plate and
    laser, each axis.  State: `elements` (3, elements), `crept` (3, terms), `motion` (2, modes), `line` (delay + 1, 6),
    `late` (laser's delay + 1, 3), `lines` of one `LINES`, `random` (1,).
    """

    axes: np.ndarray
    threshold: np.ndarray
    weight: np.ndarray
    creep: np.ndarray
    table: np.ndarray
    sensors: np.ndarray
    elements: np.ndarray
    crept: np.ndarray
    motion: np.ndarray
    line: np.ndarray
    late: np.ndarray
    lines: np.ndarray
    random: np.ndarray


@njit(cache=True, nogil=True, inline="always")
def low_passed(state: float, before: float, now: float, pole: float, newest: float) -> float:
    """Return a first-order low-pass' state after a sample in which its input went straight from `before` to `now`."""
    return flushed(pole * state + (1.0 - pole - newest) * before + newest * now)


@njit(cache=True, nogil=True)
def expand(axis: int, voltage: float, stage: Stage) -> float:
    """Return a stack's free expansion, m, halfway through a sample over which `voltage` (V) is asked for."""
    own = stage.axes[axis]
    asked = min(max(voltage - own.low, 0.0), own.reach)
    step = min(max((1.0 - own.amplifier) * (asked - own.asked), -own.slew), own.slew)
    amplified = flushed(own.asked + step)
    own.lagged = low_passed(own.lagged, own.asked, amplified, own.lag, own.lag_now)
    own.asked = amplified
    before, now = own.used, own.lagged / own.reach
    own.used = now
    elements, numbers = stage.elements[axis], own.hysteresis
    fast = numbers[SLOPE] * now
    if own.kind == BOUC_WEN:
        own.state = bouc_wen(before, now, own.state, numbers)
        fast -= own.state
    elif own.kind == PLAYS:
        fast += plays(now, elements, stage.threshold[axis], stage.weight[axis])
    elif own.kind == MAXWELL_SLIP:
        limit, stiff = stage.threshold[axis], stage.weight[axis]
        own.state = charge(before, now, own.state, elements, limit, stiff, numbers)
        fast = numbers[SLOPE] * own.state
    fast += 4.0 * own.curve * fast * (1.0 - fast)
    crept, creep = stage.crept[axis], stage.creep[axis]
    total = (1.0 + own.at_once) * fast
    for i in range(crept.shape[0]):
        crept[i] = flushed(crept[i] + creep[0, i] * (fast - crept[i]))
        total += creep[1, i] * crept[i]
    before, own.expanded = own.expanded, own.stroke * total
    return float(0.5 * (before + own.expanded))


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
        own = stage.axes[axis]
        numbers = own.guide
        if numbers[COULOMB] == 0.0:
            continue
        speed = 0.0
        for m in range(stage.motion.shape[1]):
            speed += stage.table[14 + axis, m] * stage.motion[1, m]
        drag, own.bristle = bristles(speed, own.step, own.bristle, numbers)
        force[axis] -= drag


@njit(cache=True, nogil=True)
def _filtered(sensor: int, axis: int, value: float, stage: Stage) -> float:
    """Return what a sensor's two low-passes make of a value, m."""
    given = stage.sensors[sensor, axis]
    states = given.states
    first = low_passed(states[1], states[0], value, given.filter, given.now)
    states[2] = low_passed(states[2], states[1], first, given.filter, given.now)
    states[0], states[1] = value, first
    return float(states[2])


@njit(cache=True, nogil=True)
def _read(sensor: int, axis: int, value: float, stage: Stage) -> float:
    """Return what a sensor shows of a value, m: its gain, noise, range and steps."""
    given = stage.sensors[sensor, axis]
    noisy = given.gain * value + given.rms * NOISE_SCALE * four_uniforms(stage.random)
    return float(given.resolution * np.rint(min(max(noisy, given.bottom), given.top) / given.resolution))


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
    lines = stage.lines[0]
    at, later = lines.at, lines.later
    for n in range(voltage.shape[0]):
        for axis in range(3):
            expansion[axis] = expand(axis, voltage[n, axis], stage)
        _push(force[n], stage, pushed)
        _move(expansion, pushed, stage.motion, stage.table)
        for axis in range(3):
            stack = stage.axes[axis].residual * stage.axes[axis].expanded
            plate = 0.0
            for m in range(stage.motion.shape[1]):
                stack += stage.table[11 + axis, m] * stage.motion[0, m]
                plate += stage.table[14 + axis, m] * stage.motion[0, m]
            stage.line[at, axis] = _filtered(0, axis, stack, stage)
            stage.line[at, 3 + axis] = _filtered(1, axis, plate, stage)
            stage.late[later, axis] = _filtered(2, axis, plate + base[n, axis], stage)
        at = at + 1 if at + 1 < stage.line.shape[0] else 0
        later = later + 1 if later + 1 < stage.late.shape[0] else 0
        lines.phase += lines.cycles
        fires = lines.phase >= 1.0
        lines.phase -= 1.0 if fires else 0.0
        for axis in range(3):  # the oldest is shown
            extension[n, axis] = _read(0, axis, stage.line[at, axis], stage)
            position[n, axis] = _read(1, axis, stage.line[at, 3 + axis], stage)
            if fires:
                stage.axes[axis].shown = _read(2, axis, stage.late[later, axis], stage)
            absolute[n, axis] = stage.axes[axis].shown
    lines.at, lines.later = at, later
