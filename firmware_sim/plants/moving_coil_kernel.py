"""A moving-coil vibrator at large signals, sample by sample: Runge and Kutta's fourth-order rule with the drive held.

Rows of `state` are units, each with its displacement and velocity (of the rigid plate, in space), the coil's current,
the current in the iron, what crept in each branch, displacements and then velocities of the plate's modes; the last row
is the housing's displacement and velocity.  What is heard is the acceleration at mid-sample, so that holding the drive
delays nothing.
"""

import math

import numpy as np

from firmware_sim.plants.flush_kernel import flushed
from rigkit.compiled import njit

# Columns of `unit`; lengths are re the linear excursion, 1 / LIMIT.
MASS, STIFFNESS, RELAXED, DAMPING, SPEED, AREA, FACING, SOFT = range(8)
ASYMMETRY, QUADRATIC, QUARTIC, LIMIT = 8, 9, 10, 11
FACTOR, FIELD_2, FIELD_4, OFFSET = 12, 13, 14, 15
RESISTANCE, INDUCTANCE, IRON_INDUCTANCE, IRON_RESISTANCE, MODULATION, SATURATING, SATURATION = range(16, 23)
COLUMNS = 23
# Entries of `body`: the housing's mass kg, its mounts' stiffness N/m and damping N s/m; the gas' pressure Pa, volume
# m^3 and ratio of heats.
HOUSING, MOUNT, LOSS, PRESSURE, VOLUME, RATIO = range(6)
# Entries of `thermal`: rise of a coil over its magnet K/W and its time s; rise of the magnet K/W and its time s.
RISE, TIME, MAGNET_RISE, MAGNET_TIME = range(4)
# Columns of `modes` (units, modes, 4): omega^2, 2 zeta omega, and the shape at coil and sensor.
SQUARE, DECAY, DRIVEN, HEARD = range(4)
# Columns of `creep` and `slips` (units, branches, 2): stiffness N/m, and rate 1/s or the force at which it slips N.
Y, V, CURRENT, EDDY, CREPT = range(5)
COPPER = 0.0039
"""1/K: how resistance grows with temperature."""
TIGHTEST = 0.05
"""1: of the gas' volume, at least."""


@njit(cache=True, nogil=True, error_model="numpy")
def force_factor(place: float, row: np.ndarray) -> float:
    """Return Bl(x), N/A: falls off the field's middle, `row[FACTOR]` at rest; `place` is x re the excursion."""
    away, rest = (place - row[OFFSET]) ** 2, row[OFFSET] ** 2
    level = 1.0 + rest * (row[FIELD_2] + rest * row[FIELD_4])
    factor: float = row[FACTOR] * level / (1.0 + away * (row[FIELD_2] + away * row[FIELD_4]))
    return factor


@njit(cache=True, nogil=True, error_model="numpy")
def gas_pressure(swept: float, body: np.ndarray) -> float:
    """Return by how much the gas is over its pressure at rest, Pa, with `swept` m^3 more room: adiabatic."""
    room = max(1.0 + swept / body[VOLUME], TIGHTEST)
    over: float = body[PRESSURE] * (room ** -body[RATIO] - 1.0)
    return over


@njit(cache=True, nogil=True, error_model="numpy")
def seal_force(moved: float, held: np.ndarray, slips: np.ndarray) -> float:
    """Return a seal's friction, N: springs that slip [Iwan 1966], `moved` m since they were at `held` (branches,) N."""
    total = 0.0
    for j in range(held.shape[0]):
        total += min(max(held[j] + slips[j, 0] * moved, -slips[j, 1]), slips[j, 1])
    return total


@njit(cache=True, nogil=True, error_model="numpy")
def suspension_force(x: float, v: float, row: np.ndarray, state: np.ndarray, creep: np.ndarray) -> float:
    """Return what the suspension pulls back with, N: K(x) x, creep, and a damping R sqrt(1 + (v / speed)^2) v."""
    place = x * row[LIMIT]
    harder = place * (row[ASYMMETRY] + place * (row[QUADRATIC] + place * place * row[QUARTIC]))
    force = (row[RELAXED] + row[STIFFNESS] * harder) * x
    for j in range(creep.shape[0]):
        force += creep[j, 0] * (x - state[CREPT + j])
    ratio = v * row[SPEED]
    pull: float = row[SOFT] * force + row[DAMPING] * math.sqrt(1.0 + ratio * ratio) * v
    return pull


@njit(cache=True, nogil=True, error_model="numpy")
def motor_force(
    voltage: float, x: float, v: float, row: np.ndarray, hot: float, state: np.ndarray, slope: np.ndarray
) -> float:
    """Return a coil's force, N, and fill in how its currents change.

    Flux of the coil L l(x) ((1 - s) i + s i / sqrt(1 + (i / I)^2)), of the iron L2 l(x) i2; each force is the change
    of co-energy with x, so that the motor gives no more than it takes [Klippel 2006, sec. 2; Woodson and Melcher 1968].
    """
    place, current, eddy = x * row[LIMIT], state[CURRENT], state[EDDY]
    factor, bend = force_factor(place, row), 1.0 / math.sqrt(1.0 + place * place)
    inside = 1.0 - row[MODULATION] * place * bend
    inside_slope = -row[MODULATION] * row[LIMIT] * bend * bend * bend
    ratio, share = current * row[SATURATION], row[SATURATING]
    root = math.sqrt(1.0 + ratio * ratio)
    linked = row[INDUCTANCE] * current * (1.0 - share + share / root)
    growth = row[INDUCTANCE] * inside * (1.0 - share + share / (root * root * root))
    into_iron = row[IRON_RESISTANCE] * (current - eddy)
    induced = (factor + linked * inside_slope) * v
    slope[CURRENT] = (voltage - hot * current - into_iron - induced) / growth
    slope[EDDY] = (into_iron / row[IRON_INDUCTANCE] - inside_slope * v * eddy) / inside
    energy = 0.5 * row[IRON_INDUCTANCE] * eddy * eddy
    # i^2 / (1 + root) is I^2 (root - 1), without its cancellation
    energy += row[INDUCTANCE] * current * current * (0.5 * (1.0 - share) + share / (1.0 + root))
    force: float = factor * current + inside_slope * energy
    return force


@njit(cache=True, nogil=True, error_model="numpy")
def motion(state: np.ndarray, c: int, facing: float, modes: np.ndarray) -> tuple[float, float]:
    """Return how far a coil is out of its gap, m, and how fast it goes there, m/s."""
    housing, count, first = state.shape[0] - 1, modes.shape[1], state.shape[1] - 2 * modes.shape[1]
    x, v = state[c, Y] - facing * state[housing, Y], state[c, V] - facing * state[housing, V]
    for m in range(count):
        x += modes[c, m, DRIVEN] * state[c, first + m]
        v += modes[c, m, DRIVEN] * state[c, first + count + m]
    return x, v


@njit(cache=True, nogil=True, error_model="numpy")
def _move_unit(force: float, mass: float, x: float, state: np.ndarray, slope: np.ndarray, creep: np.ndarray) -> None:
    """Fill in how a unit's plate moves and its suspension creeps."""
    slope[Y], slope[V] = state[V], force / mass
    for j in range(creep.shape[0]):
        slope[CREPT + j] = (x - state[CREPT + j]) * creep[j, 1]


@njit(cache=True, nogil=True, error_model="numpy")
def _move_modes(acceleration: float, state: np.ndarray, slope: np.ndarray, modes: np.ndarray) -> None:
    """Fill in how a plate's modes move; their modal mass is the plate's."""
    count, first = modes.shape[0], state.shape[0] - 2 * modes.shape[0]
    for m in range(count):
        q, rate = state[first + m], state[first + count + m]
        slope[first + m] = rate
        slope[first + count + m] = modes[m, DRIVEN] * acceleration - modes[m, SQUARE] * q - modes[m, DECAY] * rate


@njit(cache=True, nogil=True, error_model="numpy")
def fill_slopes(
    state: np.ndarray,
    slope: np.ndarray,
    voltage: np.ndarray,
    machine: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray],
    hot: np.ndarray,
    seal: tuple[np.ndarray, np.ndarray],
    places: np.ndarray,
) -> None:
    """Fill in how all of the state changes.

    `voltage` and `hot` (units,) V and ohm; `machine` is unit, modes, creep, slips and body; `seal` where its springs
    were last held, forces (units, branches) N and places (units,) m; `places` (units, 2) is room.
    """
    unit, modes, creep, slips, body = machine
    held, held_at = seal
    count = unit.shape[0]
    swept = 0.0
    for c in range(count):
        places[c, 0], places[c, 1] = motion(state, c, unit[c, FACING], modes)
        swept += unit[c, AREA] * places[c, 0]
    pressure = gas_pressure(swept, body)
    push = -body[MOUNT] * state[count, Y] - body[LOSS] * state[count, V]
    for c in range(count):
        row, x, v = unit[c], places[c, 0], places[c, 1]
        force = motor_force(voltage[c], x, v, row, hot[c], state[c], slope[c]) + row[AREA] * pressure
        force -= suspension_force(x, v, row, state[c], creep[c]) + seal_force(x - held_at[c], held[c], slips[c])
        _move_unit(force, row[MASS], x, state[c], slope[c], creep[c])
        _move_modes(slope[c, V], state[c], slope[c], modes[c])
        push -= row[FACING] * force
    slope[count, Y], slope[count, V] = state[count, V], push / body[HOUSING]


@njit(cache=True, nogil=True, error_model="numpy")
def _hold_seals(
    state: np.ndarray,
    machine: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray],
    seal: tuple[np.ndarray, np.ndarray],
) -> None:
    """Let the springs of the seals slip to where the state is now."""
    unit, modes, _, slips, _ = machine
    held, held_at = seal
    for c in range(unit.shape[0]):
        x, _ = motion(state, c, unit[c, FACING], modes)
        for j in range(held.shape[1]):
            pulled = held[c, j] + slips[c, j, 0] * (x - held_at[c])
            held[c, j] = flushed(min(max(pulled, -slips[c, j, 1]), slips[c, j, 1]))
        held_at[c] = x


@njit(cache=True, nogil=True, error_model="numpy")
def _listen(slope: np.ndarray, modes: np.ndarray, heard: np.ndarray) -> None:
    """Fill in the accelerations at the sensors, `heard` (units,) m/s^2."""
    count = modes.shape[1]
    first = slope.shape[1] - count
    for c in range(modes.shape[0]):
        heard[c] = slope[c, V]
        for m in range(count):
            heard[c] += modes[c, m, HEARD] * slope[c, first + m]


@njit(cache=True, nogil=True, error_model="numpy")
def _warm_up(
    state: np.ndarray, unit: np.ndarray, hot: np.ndarray, heat: np.ndarray, thermal: np.ndarray, step: float
) -> None:
    """Let coils and magnets grow warm or cold, and fill in the coils' resistance."""
    for c in range(unit.shape[0]):
        power = hot[c] * state[c, CURRENT] * state[c, CURRENT]
        heat[c, 0] = flushed(heat[c, 0] + step / thermal[TIME] * (power * thermal[RISE] - heat[c, 0]))
        heat[c, 1] = flushed(heat[c, 1] + step / thermal[MAGNET_TIME] * (power * thermal[MAGNET_RISE] - heat[c, 1]))
        hot[c] = unit[c, RESISTANCE] * (1.0 + COPPER * (heat[c, 0] + heat[c, 1]))


@njit(cache=True, nogil=True, error_model="numpy")
def _ahead(state: np.ndarray, slopes: np.ndarray, parts: tuple[float, float, float, float], stage: np.ndarray) -> None:
    """Fill `stage` with the state, changed by so many s of each slope."""
    a, b, c, d = parts
    for r in range(state.shape[0]):
        for k in range(state.shape[1]):
            change = a * slopes[0, r, k] + b * slopes[1, r, k] + c * slopes[2, r, k] + d * slopes[3, r, k]
            stage[r, k] = flushed(state[r, k] + change)


@njit(cache=True, nogil=True, error_model="numpy")
def _fill_stages(
    state: np.ndarray,
    slopes: np.ndarray,
    voltage: np.ndarray,
    machine: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray],
    hot: np.ndarray,
    seal: tuple[np.ndarray, np.ndarray],
    places: np.ndarray,
    step: float,
) -> None:
    """Fill in the four slopes of a step; `slopes` (5, rows, columns) has room for a stage."""
    stage = slopes[4]
    fill_slopes(state, slopes[0], voltage, machine, hot, seal, places)
    _ahead(state, slopes, (0.5 * step, 0.0, 0.0, 0.0), stage)
    fill_slopes(stage, slopes[1], voltage, machine, hot, seal, places)
    _ahead(state, slopes, (0.0, 0.5 * step, 0.0, 0.0), stage)
    fill_slopes(stage, slopes[2], voltage, machine, hot, seal, places)
    _ahead(state, slopes, (0.0, 0.0, step, 0.0), stage)
    fill_slopes(stage, slopes[3], voltage, machine, hot, seal, places)


@njit(cache=True, nogil=True, error_model="numpy")
def run_moving_coils(
    drive: np.ndarray,
    heard: np.ndarray,
    gain: float,
    machine: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray],
    thermal: np.ndarray,
    memory: tuple[np.ndarray, np.ndarray, np.ndarray, tuple[np.ndarray, np.ndarray], np.ndarray],
    timing: tuple[float, int],
    work: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray],
) -> None:
    """Fill `heard` (frames, units) m/s^2 from `drive` (frames, units) V.

    `memory` is state, heat (units, 2) K, resistance (units,) ohm, seal, and the sum of (x / excursion)^2 (units,); it
    is moved on.  `timing` is a step, s, and how many make a sample, an odd number; `work` room: four slopes and a stage
    (5, rows, columns), voltages (units,), places (units, 2), and a slope at mid-step (rows, columns).
    """
    state, heat, hot, seal, worked = memory
    step, steps = timing
    slopes, voltage, places, middle = work
    unit, modes, stage = machine[0], machine[1], slopes[4]
    for n in range(drive.shape[0]):
        for c in range(unit.shape[0]):
            voltage[c] = gain * drive[n, c]
        for k in range(steps):
            _fill_stages(state, slopes, voltage, machine, hot, seal, places, step)
            if 2 * k + 1 == steps:  # the third-order solution at mid-step
                _ahead(state, slopes, (5 * step / 24, step / 6, step / 6, -step / 24), stage)
                fill_slopes(stage, middle, voltage, machine, hot, seal, places)
                _listen(middle, modes, heard[n])
                for c in range(unit.shape[0]):
                    worked[c] += (places[c, 0] * unit[c, LIMIT]) ** 2
            _ahead(state, slopes, (step / 6, step / 3, step / 3, step / 6), state)
            _hold_seals(state, machine, seal)
        _warm_up(state, unit, hot, heat, thermal, step * steps)
