"""The compiled kernel of a macro and a micro manipulator: guided motion and its arm, an inner loop and its process."""

from typing import NamedTuple

import numpy as np

from firmware_sim.plants.flush_kernel import flushed
from firmware_sim.plants.record import Record
from rigkit.compiled import njit

OWN = np.dtype(
    [
        ("steps", "i8"),  # a sample
        ("filter", "f8"),  # a filter's pole
        ("filters", "i8"),  # how many
        ("fastest", "f8"),  # m a step
        ("inner", "f8"),  # 1/s
        ("limit", "f8"),  # m/s
        ("process", "f8"),  # m a step for m/s
        ("lag", "f8"),  # a lag's pole
        ("stop", "f8"),  # m
        ("share", "f8"),  # 1
        ("disturbed", "f8"),  # samples
        ("disturbance", "f8"),  # m
        # state
        ("done", "i8"),  # samples
        ("at", "i8"),  # where the line is written
        # m
        ("filtered", "f8"),
        ("again", "f8"),
        ("planned", "f8"),
        ("speed", "f8"),  # m/s
        ("place", "f8"),  # m
    ],
    align=True,
)
"""What every pair has."""


class Pair(NamedTuple):
    """All arrays of a pair.

    `own` of one `OWN`; `arm` (n, n + 2), the macro manipulator's x' = A x + B u, y = C x as A, B and C; `mode` (2, 3),
    the micro's own as A and B; `noise` (3,), m of relative, fast and slow; `gains` (n, 2), samples and times; state:
    `line` (dead time + 1,), m, `moved` (n,), `ringing` (2,), m and m/s.
    """

    own: np.ndarray
    arm: np.ndarray
    mode: np.ndarray
    noise: np.ndarray
    gains: np.ndarray
    line: np.ndarray
    moved: np.ndarray
    ringing: np.ndarray


@njit(cache=True, nogil=True)
def _guide(wanted: float, own: Record, line: np.ndarray) -> float:
    """Return what the arm is led to a step later, m: delayed, filtered, no faster than it may be."""
    at = own.at
    line[at] = wanted
    at = at + 1 if at + 1 < line.shape[0] else 0
    own.at = at
    own.filtered = flushed(own.filtered + (1.0 - own.filter) * (line[at] - own.filtered))
    asked = own.filtered
    if own.filters > 1:
        own.again = flushed(own.again + (1.0 - own.filter) * (asked - own.again))
        asked = own.again
    own.planned = flushed(own.planned + min(max(asked - own.planned, -own.fastest), own.fastest))
    return float(own.planned)


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
def _seen(own: Record, ringing: np.ndarray) -> float:
    """Return the micro manipulator's place, m, its mode in it."""
    return float((1.0 - own.share) * own.place + own.share * ringing[0])


@njit(cache=True, nogil=True)
def _drive(signal: float, gain: float, own: Record, mode: np.ndarray, ringing: np.ndarray) -> None:
    """Move the micro manipulator on by a step under a control signal, m/s."""
    limited = min(max(signal, -own.limit), own.limit)
    before = own.speed
    own.speed = flushed(own.lag * before + (1.0 - own.lag) * limited)
    was = own.place
    place = was + gain * own.process * 0.5 * (before + own.speed)
    own.place = flushed(min(max(place, -own.stop), own.stop))
    middle = 0.5 * (was + own.place)
    first, second = ringing[0], ringing[1]
    ringing[0] = flushed(mode[0, 0] * first + mode[0, 1] * second + mode[0, 2] * middle)
    ringing[1] = flushed(mode[1, 0] * first + mode[1, 1] * second + mode[1, 2] * middle)


@njit(cache=True, nogil=True)
def run(asked: tuple[np.ndarray, ...], shown: tuple[np.ndarray, ...], pair: Pair, random: np.random.Generator) -> None:
    """Run one frame; signals as in `ManipulatorPairPlant.run`, (frames,) each."""
    (wanted, slow_wanted), (relative, fast, slow, control, position) = asked, shown
    own, ringing, room = pair.own[0], pair.ringing, np.empty(pair.moved.shape[0])
    for n in range(wanted.shape[0]):
        done = own.done
        gain, place = 1.0, 0.0
        for row in range(pair.gains.shape[0]):
            if done >= pair.gains[row, 0]:
                gain = pair.gains[row, 1]
        control[n] = own.inner * (wanted[n] - _seen(own, ringing))
        for _ in range(own.steps):
            _drive(own.inner * (wanted[n] - _seen(own, ringing)), gain, own, pair.mode, ringing)
            place = _move(_guide(slow_wanted[n], own, pair.line), pair, room)
        own.done += 1
        near = _seen(own, ringing)
        position[n] = near + place + (own.disturbance if own.done >= own.disturbed else 0.0)
        relative[n] = position[n] + pair.noise[0] * random.standard_normal()
        fast[n] = near + pair.noise[1] * random.standard_normal()
        slow[n] = place + pair.noise[2] * random.standard_normal()
