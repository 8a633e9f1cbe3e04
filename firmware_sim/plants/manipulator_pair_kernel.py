"""The compiled kernel of a macro and a micro manipulator: guided motion and its arm, an inner loop and its process."""

from typing import NamedTuple

import numpy as np
from numba import njit

from firmware_sim.plants.flush_kernel import flushed

(STEPS, PERIOD, FILTER, FILTERS, FASTEST, INNER, LIMIT, PROCESS, LAG, STOP, SHARE, DISTURBED, DISTURBANCE,
 GIVEN) = range(14)  # fmt: skip
"""Of `given`: steps a sample, s a step, a filter's pole, how many, m a step, 1/s, m/s, m a step for m/s, a lag's pole,
m, 1, samples, m."""
DONE, FILTERED, AGAIN, PLANNED, SPEED, PLACE, STATES = range(7)
"""Of `state`: samples, m three times, m/s, m."""


class Pair(NamedTuple):
    """All arrays of a pair.

    `given` (GIVEN,); `arm` (n, n + 2), the macro manipulator's x' = A x + B u, y = C x as A, B and C; `mode` (2, 3),
    the micro's own as A and B; `noise` (3,), m of relative, fast and slow; `gains` (n, 2), samples and times; state:
    `line` (dead time + 1,), m, `ends` (1,), where that is written, `state` (STATES,), `moved` (n,), `ringing` (2,), m
    and m/s.
    """

    given: np.ndarray
    arm: np.ndarray
    mode: np.ndarray
    noise: np.ndarray
    gains: np.ndarray
    line: np.ndarray
    ends: np.ndarray
    state: np.ndarray
    moved: np.ndarray
    ringing: np.ndarray


@njit(cache=True, nogil=True)
def _guide(wanted: float, pair: Pair) -> float:
    """Return what the arm is led to a step later, m: delayed, filtered, no faster than it may be."""
    given, state, at = pair.given, pair.state, pair.ends[0]
    pair.line[at] = wanted
    at = at + 1 if at + 1 < pair.line.shape[0] else 0
    pair.ends[0] = at
    state[FILTERED] = flushed(state[FILTERED] + (1.0 - given[FILTER]) * (pair.line[at] - state[FILTERED]))
    asked = state[FILTERED]
    if given[FILTERS] > 1.0:
        state[AGAIN] = flushed(state[AGAIN] + (1.0 - given[FILTER]) * (asked - state[AGAIN]))
        asked = state[AGAIN]
    state[PLANNED] = flushed(state[PLANNED] + min(max(asked - state[PLANNED], -given[FASTEST]), given[FASTEST]))
    return float(state[PLANNED])


@njit(cache=True, nogil=True)
def _move(asked: float, pair: Pair, room: np.ndarray) -> float:
    """Move the macro manipulator on by a step; return its place, m."""
    arm, moved = pair.arm, pair.moved
    order, place = moved.shape[0], 0.0
    for i in range(order):
        room[i] = arm[i, order] * asked
        for j in range(order):
            room[i] += arm[i, j] * moved[j]
    for i in range(order):
        moved[i] = flushed(room[i])
        place += arm[i, order + 1] * moved[i]
    return place


@njit(cache=True, nogil=True)
def _seen(pair: Pair) -> float:
    """Return the micro manipulator's place, m, its mode in it."""
    share = pair.given[SHARE]
    return float((1.0 - share) * pair.state[PLACE] + share * pair.ringing[0])


@njit(cache=True, nogil=True)
def _drive(signal: float, gain: float, pair: Pair) -> None:
    """Move the micro manipulator on by a step under a control signal, m/s."""
    given, state, ringing, mode = pair.given, pair.state, pair.ringing, pair.mode
    limited = min(max(signal, -given[LIMIT]), given[LIMIT])
    before = state[SPEED]
    state[SPEED] = flushed(given[LAG] * before + (1.0 - given[LAG]) * limited)
    was = state[PLACE]
    place = was + gain * given[PROCESS] * 0.5 * (before + state[SPEED])
    state[PLACE] = flushed(min(max(place, -given[STOP]), given[STOP]))
    middle = 0.5 * (was + state[PLACE])
    first, second = ringing[0], ringing[1]
    ringing[0] = flushed(mode[0, 0] * first + mode[0, 1] * second + mode[0, 2] * middle)
    ringing[1] = flushed(mode[1, 0] * first + mode[1, 1] * second + mode[1, 2] * middle)


@njit(cache=True, nogil=True)
def run(wanted, slow_wanted, relative, fast, slow, control, position, pair, random):  # type: ignore[no-untyped-def]
    """Run one frame; signals as in `ManipulatorPairPlant.run`, (frames,) each."""
    given, room = pair.given, np.empty(pair.moved.shape[0])
    for n in range(wanted.shape[0]):
        done = pair.state[DONE]
        gain, place = 1.0, 0.0
        for row in range(pair.gains.shape[0]):
            if done >= pair.gains[row, 0]:
                gain = pair.gains[row, 1]
        control[n] = given[INNER] * (wanted[n] - _seen(pair))
        for _ in range(int(given[STEPS])):
            _drive(given[INNER] * (wanted[n] - _seen(pair)), gain, pair)
            place = _move(_guide(slow_wanted[n], pair), pair, room)
        pair.state[DONE] += 1.0
        near = _seen(pair)
        position[n] = near + place + (given[DISTURBANCE] if pair.state[DONE] >= given[DISTURBED] else 0.0)
        relative[n] = position[n] + pair.noise[0] * random.standard_normal()
        fast[n] = near + pair.noise[1] * random.standard_normal()
        slow[n] = place + pair.noise[2] * random.standard_normal()
