"""The compiled kernel that moves a tool from segment to segment and along them."""

import math

import numpy as np

from rigkit.compiled import njit
from rigkit.record import Record

WAITING, MOVING, PAUSING, MILLING, ENDED = range(5)
"""Of `phase`."""
MOVE = np.dtype(
    [
        ("phase", "i8"),
        ("number", "f8"),  # of the segment
        ("leg", "i8"),  # from 0
        ("time", "f8"),  # s in the leg or the segment
        ("length", "f8"),  # m, of it
        ("place", "f8"),  # m along it
        ("duration", "f8"),  # s, of the last segment
        ("controlled", "f8"),  # s of force control
        ("has_begun", "?"),
        # the force where it is stationary
        ("count", "i8"),  # samples
        ("mean", "f8"),  # N
        ("squares", "f8"),  # N^2
        # settings
        ("wide", "f8"),  # G, cells
        ("lift", "f8"),  # m
        ("travel", "f8"),  # m/s
        ("plunge", "f8"),  # m/s
        ("step", "f8"),  # m/s
        ("acceleration", "f8"),  # m/s^2
        ("pause", "f8"),  # s
        ("stationary", "f8"),  # s
        ("controlling", "f8"),  # the phase of force control
        ("period", "f8"),  # s
        ("side", "f8"),  # m a cell
        # m: the ends of the leg, and of the segment; above the pocket's middle
        ("begin", "f8", 3),
        ("end", "f8", 3),
        ("start", "f8", 3),
        ("stop", "f8", 3),
        ("home", "f8", 3),
    ],
    align=True,
)
NEAR = 5e-6
"""m before the end that are the end."""


@njit(cache=True, nogil=True)
def _leg_time(length: float, speed: float, acceleration: float) -> float:
    """Return how long a leg takes, s, at `speed` (m/s), with raised-cosine ramps of the mean acceleration."""
    if length <= 0.0:
        return 0.0
    if length < speed * speed / acceleration:
        return 2.0 * math.sqrt(length / acceleration)
    return length / speed + speed / acceleration


@njit(cache=True, nogil=True)
def _way(time: float, length: float, speed: float, acceleration: float) -> float:
    """Return how far along a leg the tool is, m, after `time`, s."""
    whole = _leg_time(length, speed, acceleration)
    if time >= whole:
        return length
    ramp = min(speed / acceleration, 0.5 * whole)
    top = length / (whole - ramp)
    if time < ramp:
        return 0.5 * top * (time - ramp / math.pi * math.sin(math.pi * time / ramp))
    if time <= whole - ramp:
        return top * (time - 0.5 * ramp)
    left = whole - time
    return length - 0.5 * top * (left - ramp / math.pi * math.sin(math.pi * left / ramp))


@njit(cache=True, nogil=True)
def _begin_leg(move: Record, is_lifted: bool) -> bool:
    """Lay out the leg to come; return False where there is none left.

    A lifted move goes up, across and down, another one straight.
    """
    start, to = move.begin, move.end
    leg = move.leg
    if leg > (2 if is_lifted else 0):
        return False
    for r in range(3):
        start[r], to[r] = move.end[r], move.start[r]
    if is_lifted and leg == 0:
        to[0], to[1], to[2] = start[0], start[1], move.lift
    elif is_lifted and leg == 1:
        to[2] = move.lift
    total = 0.0
    for r in range(3):
        total += (to[r] - start[r]) ** 2
    move.length, move.time, move.place = math.sqrt(total), 0.0, 0.0
    return True


@njit(cache=True, nogil=True)
def _move(move: Record, is_lifted: bool) -> None:
    """Go on along the legs to where the segment starts."""
    leg = move.leg
    speed = move.step
    if is_lifted:
        speed = move.plunge if leg == 2 else move.travel
    move.time += move.period
    move.place = _way(move.time, move.length, speed, move.acceleration)
    if move.place >= move.length:
        move.leg = leg + 1
        if not _begin_leg(move, is_lifted):
            move.phase, move.time = PAUSING, 0.0


@njit(cache=True, nogil=True)
def _note(move: Record, resultant: float, phase: float) -> None:
    """Take the force in where it is stationary, by Welford's method."""
    move.controlled = move.controlled + move.period if phase == move.controlling else 0.0
    if move.controlled > move.stationary:
        move.count += 1
        away = resultant - move.mean
        move.mean += away / move.count
        move.squares += away * (resultant - move.mean)


@njit(cache=True, nogil=True)
def _mill(move: Record, feed: float) -> bool:
    """Go on along the segment by a sample of `feed` (m/s), braking before its end; return whether that is reached."""
    left = move.length - move.place
    most = math.sqrt(2.0 * move.acceleration * max(left, 0.0))
    move.place = max(move.place + move.period * min(feed, most), 0.0)
    move.time += move.period
    if move.length - move.place > NEAR:
        return False
    move.place, move.phase, move.duration = move.length, ENDED, move.time
    return True


@njit(cache=True, nogil=True)
def _take(number: float, start: np.ndarray, stop: np.ndarray, is_lifted: bool, move: Record) -> None:
    """Take up a segment: where its footprint starts and stops, cells, becomes places of the tool, m."""
    half = 0.5 * move.wide
    for places, ends in ((move.start, start), (move.stop, stop)):
        places[0] = (ends[1] + half) * move.side
        places[1] = -(ends[0] + half) * move.side
        places[2] = 0.0
    if number == 0.0:  # all is milled: away, above the middle
        move.start[:], move.stop[:] = move.home, move.home
    move.number, move.leg, move.phase = number, 0, MOVING
    move.controlled, move.count, move.mean, move.squares = 0.0, 0, 0.0, 0.0
    _begin_leg(move, is_lifted)


@njit(cache=True, nogil=True)
def _step(seen: tuple[float, ...], start: np.ndarray, stop: np.ndarray, move: Record) -> bool:
    """Do a sample; return whether a segment has ended in it.

    `seen`: number, lift (1 or 0), feed (m/s), resultant force (N), phase of its control, whether it is held.
    """
    number, lift, feed, resultant, phase, holding = seen
    if holding > 0.5 or not move.has_begun:  # whether it is held is not known in the first sample
        move.has_begun = True
        return False
    is_lifted = lift > 0.5 or move.number <= 1.0
    if number != move.number and (move.phase == WAITING or move.phase == ENDED):
        _take(number, start, stop, lift > 0.5 or number <= 1.0, move)
    elif move.phase == MOVING:
        _move(move, is_lifted)
    elif move.phase == PAUSING:
        move.time += move.period
        if move.time >= move.pause:
            for r in range(3):
                move.begin[r], move.end[r] = move.start[r], move.stop[r]
            move.length = math.hypot(move.end[0] - move.begin[0], move.end[1] - move.begin[1])
            move.phase, move.time, move.place = (MILLING if move.number > 0.0 else WAITING), 0.0, 0.0
    elif move.phase == MILLING:
        _note(move, resultant, phase)
        return _mill(move, feed)
    return False


@njit(cache=True, nogil=True)
def run(seen: tuple[np.ndarray, ...], asked: tuple[np.ndarray, ...], moves: np.ndarray) -> None:
    """Run one frame; `seen` and `asked` are the ports in and out of `SegmentMove`, `moves` of one `MOVE`."""
    number, start, stop, lift, feed, resultant, phase, holding = seen
    place, direction, is_running, is_finished, is_resting, duration, force_deviation = asked
    move = moves[0]
    for n in range(len(number)):
        now = number[n, 0], lift[n, 0], feed[n, 0], resultant[n, 0], phase[n, 0], holding[n, 0]
        ended = _step(now, start[n], stop[n], move)
        part = move.place / move.length if move.length > 0.0 else 0.0
        for r in range(3):
            place[n, r] = move.begin[r] + part * (move.end[r] - move.begin[r])
        long = math.hypot(move.stop[0] - move.start[0], move.stop[1] - move.start[1])
        for r in range(2):
            direction[n, r] = (move.stop[r] - move.start[r]) / long if long > 0.0 else 1.0 - r
        is_running[n, 0] = 1.0 if move.phase == MILLING else 0.0
        is_finished[n, 0] = 1.0 if ended else 0.0
        is_resting[n, 0] = 1.0 if move.phase == WAITING else 0.0
        duration[n, 0] = move.duration
        spread = move.squares / (move.count - 1.0) if move.count > 1.0 else 0.0
        force_deviation[n, 0] = math.sqrt(max(spread, 0.0))
