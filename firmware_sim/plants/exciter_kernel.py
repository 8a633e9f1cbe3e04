"""A driven linear structure with nonlinear elements in it, sample by sample: exact between forces that are held.

The state is real parts and then imaginary parts of all modes.  Rows of `look` see of it, at mid-step: each coil's
displacement, each coil's velocity, each element's elongation, its rate, each sensor's acceleration.  Rows of `push` are
what the forces, coils' first, do to it over a step.  Forces are those at mid-step, predicted by the free motion up to
there, and held: of second order in the step, where those at its beginning would feed oscillations.
"""

import math

import numpy as np

from firmware_sim.plants.flush_kernel import flushed
from firmware_sim.plants.friction_kernel import dahl, lugre
from firmware_sim.plants.record import Record
from rigkit.compiled import njit

FAST = {"reassoc", "contract", "nsz"}

# Columns of `coils`: force factor N/A, resistance ohm, decay of the current over a step, rest position off the field's
# middle m, and its width m (0: a uniform field).
FACTOR, RESISTANCE, DECAY, OFFSET, WIDTH = range(5)
# Columns of `elements`: a spring's cubic stiffness N/m^3 and sag m; Dahl's Coulomb force N and travel m; LuGre's six
# (see `friction_kernel.stribeck`); the stiffness N/m and damping N s/m of a joint with backlash, and its two faces m.
CUBIC, SAG, COULOMB, TRAVEL, LUGRE, STIFFNESS, CONTACT, NEAR, FAR = 0, 1, 2, 3, 4, 10, 11, 12, 13
COLUMNS = 14
# Rows of `memory`: a coil's current A (in the first columns), Dahl's strain, LuGre's bristles m.
CURRENT, STRAIN, BRISTLE = range(3)
AMPLIFIER = np.dtype([("gain", "f8"), ("clip", "f8"), ("sharpness", "i8"), ("step", "f8")], align=True)
"""V/V, V, 1, and s of a step."""


@njit(cache=True, nogil=True)
def amplified(drive: float, gain: float, clip: float, sharpness: int) -> float:
    """Return an amplifier's voltage, V: `gain` V/V, saturating softly at `clip` V (0: never).

    u / (1 + |u / clip|^2p)^(1/2p) with p = `sharpness` 1, 2 or 4 [Rapp 1991].
    """
    voltage = gain * drive
    if clip <= 0.0:
        return voltage
    power = (voltage / clip) ** 2
    if sharpness == 1:
        return voltage / math.sqrt(1.0 + power)
    if sharpness == 2:
        return voltage / math.sqrt(math.sqrt(1.0 + power * power))
    power *= power
    return voltage / math.sqrt(math.sqrt(math.sqrt(1.0 + power * power)))


@njit(cache=True, nogil=True)
def force_factor(displacement: float, coil: np.ndarray) -> float:
    """Return BL(x), N/A: a bell about the field's middle, `coil[FACTOR]` at rest."""
    factor: float = coil[FACTOR]
    if coil[WIDTH] <= 0.0:
        return factor
    here, rest = (displacement - coil[OFFSET]) / coil[WIDTH], coil[OFFSET] / coil[WIDTH]
    factor *= math.exp(rest * rest - here * here)
    return factor


@njit(cache=True, nogil=True)
def element_force(
    longer: float, velocity: float, law: np.ndarray, memory: np.ndarray, which: int, step: float
) -> float:
    """Return the mean force of an element over a step, N, against its elongation (m), and move its friction on."""
    force: float = law[CUBIC] * longer * longer * (longer + 3.0 * law[SAG])
    if law[COULOMB] > 0.0:
        before = memory[STRAIN, which]
        memory[STRAIN, which] = dahl(before, velocity, law[TRAVEL], step)
        force += law[COULOMB] * 0.5 * (before + memory[STRAIN, which])
    if law[LUGRE] > 0.0:
        friction = law[LUGRE : LUGRE + 6]
        memory[BRISTLE, which], bristles = lugre(memory[BRISTLE, which], velocity, friction, step)
        force += bristles + friction[2] * velocity
    if law[STIFFNESS] > 0.0:
        force += contact_force(longer, velocity, law)
    return force


@njit(cache=True, nogil=True)
def contact_force(longer: float, velocity: float, law: np.ndarray) -> float:
    """Return what a joint with backlash pushes back with, N: nothing between its faces; it never pulls."""
    deep: float = max(longer - law[FAR], 0.0) + min(longer - law[NEAR], 0.0)
    force: float = law[STIFFNESS] * deep + law[CONTACT] * velocity
    return max(force, 0.0) if deep > 0.0 else min(force, 0.0) if deep < 0.0 else 0.0


@njit(cache=True, nogil=True, fastmath=FAST)
def _look(rows: np.ndarray, state: np.ndarray, seen: np.ndarray) -> None:
    """Fill `seen` (rows,) with what each row sees of the state."""
    for r in range(rows.shape[0]):
        row, total = rows[r], 0.0
        for m in range(state.shape[0]):
            total += row[m] * state[m]
        seen[r] = total


@njit(cache=True, nogil=True, fastmath=FAST)
def _move(state: np.ndarray, turn: np.ndarray, push: np.ndarray, forces: np.ndarray, pushed: np.ndarray) -> None:
    """Move the state on over one step."""
    modes = turn.shape[1]
    pushed[:] = 0.0
    for k in range(forces.shape[0]):
        force, row = forces[k], push[k]
        if force != 0.0:
            for m in range(2 * modes):
                pushed[m] += row[m] * force
    cosine, sine = turn[0], turn[1]
    real, imaginary, new_real, new_imaginary = state[:modes], state[modes:], pushed[:modes], pushed[modes:]
    for m in range(modes):
        a, b = real[m], imaginary[m]
        real[m] = flushed(cosine[m] * a - sine[m] * b + new_real[m])
        imaginary[m] = flushed(sine[m] * a + cosine[m] * b + new_imaginary[m])


@njit(cache=True, nogil=True)
def _push_back(
    seen: np.ndarray, elements: np.ndarray, memory: np.ndarray, coils: int, forces: np.ndarray, step: float
) -> None:
    """Fill in the forces of the elements."""
    first, count = 2 * coils, elements.shape[0]
    for e in range(count):
        longer, velocity = seen[first + e], seen[first + count + e]
        forces[coils + e] = -element_force(longer, velocity, elements[e], memory, coils + e, step)


@njit(cache=True, nogil=True)
def _pull(drive: float, seen: np.ndarray, c: int, coils: np.ndarray, memory: np.ndarray, amplifier: Record) -> float:
    """Return the mean force of a coil over a step, N, and move its current on."""
    coil = coils[c]
    factor = force_factor(seen[c], coil)
    voltage = amplified(drive, amplifier.gain, amplifier.clip, amplifier.sharpness) - factor * seen[coils.shape[0] + c]
    before = memory[CURRENT, c]
    memory[CURRENT, c] = flushed(coil[DECAY] * before + (1.0 - coil[DECAY]) * voltage / coil[RESISTANCE])
    pull: float = factor * 0.5 * (before + memory[CURRENT, c])
    return pull


@njit(cache=True, nogil=True)
def run_exciter(
    drive: np.ndarray,
    heard: np.ndarray,
    state: np.ndarray,
    memory: np.ndarray,
    tables: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray],
    parts: tuple[np.ndarray, np.ndarray],
    amplifiers: np.ndarray,
    work: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> None:
    """Fill `heard` (frames, sensors) m/s^2 from `drive` (frames, coils) V.

    `state` (2 modes,) and `memory` (3, forces) are moved on; `tables` are turn, push, look and direct, `parts`
    coils and elements; `amplifiers` is of one `AMPLIFIER`; `work` is room: what is seen, forces, and what they push.
    """
    turn, push, look, direct = tables
    (coils, elements), amplifier = parts, amplifiers[0]
    seen, forces, pushed = work
    count, first = coils.shape[0], 2 * forces.shape[0]
    for n in range(drive.shape[0]):
        _look(look, state, seen)
        for c in range(count):
            forces[c] = _pull(drive[n, c], seen, c, coils, memory, amplifier)
        _push_back(seen, elements, memory, count, forces, amplifier.step)
        for s in range(heard.shape[1]):
            total = seen[first + s]
            for k in range(forces.shape[0]):
                total += direct[s, k] * forces[k]
            heard[n, s] = total
        _move(state, turn, push, forces, pushed)
