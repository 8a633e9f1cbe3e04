"""The compiled kernels of hysteresis: Bouc-Wen, plays, elasto-slide elements of a charge, and LuGre friction."""

import math

import numpy as np

from firmware_sim.plants.flush_kernel import flushed
from rigkit.compiled import njit

BOUC_WEN, PLAYS, MAXWELL_SLIP, LINEAR = range(4)
"""What makes a stack's expansion from its voltage."""
GROWTH, BETA, GAMMA, POWER, SLOPE = range(5)
"""Of a Bouc-Wen's numbers: A, beta, gamma, n, and the slope of what is linear."""
ELASTIC, RESISTANCE = range(2)
"""Of a charge's numbers: volts a unit of charge, and s times that unit's volts."""
BRISTLE, LOSS, VISCOUS, COULOMB, STICTION, STRIBECK, GUIDE = range(7)
"""Of a guide's: N/m, N s/m, N s/m, N, N, m/s."""
FINEST = 0.01
"""Of a voltage's range: a larger step is taken in parts."""
PARTS = 4
"""Of a sample, in each of which a charge moves on."""


@njit(cache=True, nogil=True)
def _grow(state: float, way: float, numbers: np.ndarray) -> float:
    """Return dh/du of a Bouc-Wen state while the voltage moves in direction `way`, 1 or -1."""
    size = abs(state)
    towards = 1.0 if state * way >= 0.0 else -1.0
    power = size if numbers[POWER] == 1.0 else size ** numbers[POWER]
    return float(numbers[GROWTH] - power * (numbers[BETA] * towards + numbers[GAMMA]))


@njit(cache=True, nogil=True)
def bouc_wen(before: float, now: float, state: float, numbers: np.ndarray) -> float:
    """Return the state after the voltage, in parts of its range, went from `before` to `now`, by Runge and Kutta.

    dh = du (A - |h|^n (beta sgn(du h) + gamma)).  [Wen, ASCE J. Eng. Mech. 102 (1976) 249; Low and Guo, J.
    Microelectromech. Syst. 4 (1995) 230]
    """
    if now == before:
        return state
    steps = 1 + int(abs(now - before) / FINEST)
    step, way = (now - before) / steps, (1.0 if now > before else -1.0)
    for _ in range(steps):
        first = _grow(state, way, numbers)
        second = _grow(state + 0.5 * step * first, way, numbers)
        third = _grow(state + 0.5 * step * second, way, numbers)
        fourth = _grow(state + step * third, way, numbers)
        state += step / 6.0 * (first + 2.0 * second + 2.0 * third + fourth)
    return float(flushed(state))


@njit(cache=True, nogil=True)
def plays(now: float, state: np.ndarray, threshold: np.ndarray, weight: np.ndarray) -> float:
    """Move the plays' states on to a voltage, in parts of its range; return their weighted sum.

    [Brokate and Sprekels, Hysteresis and Phase Transitions, 1996, sec. 2.3; Kuhnen, Eur. J. Control 9 (2003) 407]
    """
    total = 0.0
    for i in range(state.shape[0]):
        state[i] = max(now - threshold[i], min(now + threshold[i], state[i]))
        total += weight[i] * state[i]
    return total


@njit(cache=True, nogil=True)
def charge(
    before: float, now: float, at: float, state: np.ndarray, limit: np.ndarray, stiff: np.ndarray, numbers: np.ndarray
) -> float:
    """Return the charge after a sample in which the voltage, in parts of its range, went from `before` to `now`.

    R q' = u - q / C - sum F_i, each F_i elastic in q up to its limit; `state` has the F_i.  By Euler's implicit rule,
    whose piecewise linear equation Newton's method solves from one side.  [Goldfarb and Celanovic, ASME J. Dyn. Syst.
    Meas. Control 119 (1997) 478]
    """
    for part in range(1, PARTS + 1):
        u, moved = before + (now - before) * part / PARTS, 0.0
        for _ in range(state.shape[0] + 3):
            slope = numbers[RESISTANCE] * PARTS + numbers[ELASTIC]
            off = slope * moved + numbers[ELASTIC] * at - u
            for i in range(state.shape[0]):
                force = state[i] + stiff[i] * moved
                if abs(force) >= limit[i] and (force > 0.0) == (moved > 0.0):
                    force = limit[i] if force > 0.0 else -limit[i]
                else:
                    slope += stiff[i]
                off += force
            if abs(off) < 1e-15:
                break
            moved -= off / slope
        for i in range(state.shape[0]):
            state[i] = min(max(state[i] + stiff[i] * moved, -limit[i]), limit[i])
        at += moved
    return float(flushed(at))


@njit(cache=True, nogil=True)
def bristles(speed: float, step: float, state: float, numbers: np.ndarray) -> tuple[float, float]:
    """Return a guide's force against a motion of `speed` (m/s), N, and its bristles' deflection a step (s) later, m.

    Exact for a speed held over the step.  [Canudas de Wit et al., IEEE TAC 40 (1995) 419, eqs. (1) to (4)]
    """
    drop = math.exp(-((speed / numbers[STRIBECK]) ** 2))
    level = numbers[COULOMB] + (numbers[STICTION] - numbers[COULOMB]) * drop
    rate = numbers[BRISTLE] * abs(speed) / level
    kept = math.exp(-step * rate)
    end = level / numbers[BRISTLE] if speed > 0.0 else -level / numbers[BRISTLE]
    mean = state
    later = state
    if rate * step > 1e-9:
        later = end + (state - end) * kept
        mean = end + (state - end) * (1.0 - kept) / (rate * step)
    elif speed != 0.0:
        later = state + step * speed
    turning = (later - state) / step
    force = numbers[BRISTLE] * mean + numbers[LOSS] * turning + numbers[VISCOUS] * speed
    return force, float(flushed(later))
