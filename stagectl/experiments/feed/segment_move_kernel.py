"""The compiled kernel that moves a tool from segment to segment and along them."""

import math

from numba import njit

WAITING, MOVING, PAUSING, MILLING, ENDED = range(5)
"""Of `PHASE`."""
(PHASE, NUMBER, LEG, TIME, LENGTH, PLACE, DURATION, CONTROLLED, COUNT, MEAN, SQUARES, HAS_BEGUN, CELLS) = range(13)
"""Of `state`: segment, leg from 0, s in the leg or the segment, its length, m, m along it, s, s of force control,
samples, N, N^2, 0 or 1."""
(WIDE, LIFT, TRAVEL, PLUNGE, STEP, ACCELERATION, PAUSE, STATIONARY, CONTROLLING, PERIOD, SIDE, SETTINGS) = range(12)
"""Of `settings`: G, cells; m; m/s three times; m/s^2; s; s; the phase of force control; s; m a cell."""
FROM, TO, START, STOP, HOME = range(5)
"""Rows of `places` (5, 3), m: the ends of the leg, and of the segment; above the pocket's middle."""
NEAR = 5e-6
"""m before the end that are the end."""


@njit(cache=True, nogil=True)
def _leg_time(length, speed, acceleration):  # type: ignore[no-untyped-def]
    """Return how long a leg takes, s, at `speed` (m/s), with raised-cosine ramps of the mean acceleration."""
    if length <= 0.0:
        return 0.0
    if length < speed * speed / acceleration:
        return 2.0 * math.sqrt(length / acceleration)
    return length / speed + speed / acceleration


@njit(cache=True, nogil=True)
def _way(time, length, speed, acceleration):  # type: ignore[no-untyped-def]
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
def _begin_leg(state, places, settings, is_lifted):  # type: ignore[no-untyped-def]
    """Lay out the leg to come; return False where there is none left.

    A lifted move goes up, across and down, another one straight.
    """
    start, to = places[FROM], places[TO]
    leg = int(state[LEG])
    if leg > (2 if is_lifted else 0):
        return False
    for r in range(3):
        start[r], to[r] = places[TO, r], places[START, r]
    if is_lifted and leg == 0:
        to[0], to[1], to[2] = start[0], start[1], settings[LIFT]
    elif is_lifted and leg == 1:
        to[2] = settings[LIFT]
    total = 0.0
    for r in range(3):
        total += (to[r] - start[r]) ** 2
    state[LENGTH], state[TIME], state[PLACE] = math.sqrt(total), 0.0, 0.0
    return True


@njit(cache=True, nogil=True)
def _move(state, places, settings, is_lifted):  # type: ignore[no-untyped-def]
    """Go on along the legs to where the segment starts."""
    leg = int(state[LEG])
    speed = settings[STEP]
    if is_lifted:
        speed = settings[PLUNGE] if leg == 2 else settings[TRAVEL]
    state[TIME] += settings[PERIOD]
    state[PLACE] = _way(state[TIME], state[LENGTH], speed, settings[ACCELERATION])
    if state[PLACE] >= state[LENGTH]:
        state[LEG] += 1.0
        if not _begin_leg(state, places, settings, is_lifted):
            state[PHASE], state[TIME] = PAUSING, 0.0


@njit(cache=True, nogil=True)
def _note(state, settings, resultant, phase):  # type: ignore[no-untyped-def]
    """Take the force in where it is stationary, by Welford's method."""
    state[CONTROLLED] = state[CONTROLLED] + settings[PERIOD] if phase == settings[CONTROLLING] else 0.0
    if state[CONTROLLED] > settings[STATIONARY]:
        state[COUNT] += 1.0
        away = resultant - state[MEAN]
        state[MEAN] += away / state[COUNT]
        state[SQUARES] += away * (resultant - state[MEAN])


@njit(cache=True, nogil=True)
def _mill(state, settings, feed):  # type: ignore[no-untyped-def]
    """Go on along the segment by a sample of `feed` (m/s), braking before its end; return whether that is reached."""
    left = state[LENGTH] - state[PLACE]
    most = math.sqrt(2.0 * settings[ACCELERATION] * max(left, 0.0))
    state[PLACE] = max(state[PLACE] + settings[PERIOD] * min(feed, most), 0.0)
    state[TIME] += settings[PERIOD]
    if state[LENGTH] - state[PLACE] > NEAR:
        return False
    state[PLACE], state[PHASE], state[DURATION] = state[LENGTH], ENDED, state[TIME]
    return True


@njit(cache=True, nogil=True)
def _take(number, start, stop, is_lifted, state, places, settings):  # type: ignore[no-untyped-def]
    """Take up a segment: where its footprint starts and stops, cells, becomes places of the tool, m."""
    half = 0.5 * settings[WIDE]
    for row, ends in ((START, start), (STOP, stop)):
        places[row, 0] = (ends[1] + half) * settings[SIDE]
        places[row, 1] = -(ends[0] + half) * settings[SIDE]
        places[row, 2] = 0.0
    if number == 0.0:  # all is milled: away, above the middle
        places[START], places[STOP] = places[HOME], places[HOME]
    state[NUMBER], state[LEG], state[PHASE] = number, 0.0, MOVING
    state[CONTROLLED] = state[COUNT] = state[MEAN] = state[SQUARES] = 0.0
    _begin_leg(state, places, settings, is_lifted)


@njit(cache=True, nogil=True)
def _step(seen, start, stop, state, places, settings):  # type: ignore[no-untyped-def]
    """Do a sample; return whether a segment has ended in it.

    `seen`: number, lift (1 or 0), feed (m/s), resultant force (N), phase of its control, whether it is held.
    """
    number, lift, feed, resultant, phase, holding = seen
    if holding > 0.5 or state[HAS_BEGUN] == 0.0:  # whether it is held is not known in the first sample
        state[HAS_BEGUN] = 1.0
        return False
    is_lifted = lift > 0.5 or state[NUMBER] <= 1.0
    if number != state[NUMBER] and (state[PHASE] == WAITING or state[PHASE] == ENDED):
        _take(number, start, stop, lift > 0.5 or number <= 1.0, state, places, settings)
    elif state[PHASE] == MOVING:
        _move(state, places, settings, is_lifted)
    elif state[PHASE] == PAUSING:
        state[TIME] += settings[PERIOD]
        if state[TIME] >= settings[PAUSE]:
            for r in range(3):
                places[FROM, r], places[TO, r] = places[START, r], places[STOP, r]
            state[LENGTH] = math.hypot(places[TO, 0] - places[FROM, 0], places[TO, 1] - places[FROM, 1])
            state[PHASE], state[TIME], state[PLACE] = (MILLING if state[NUMBER] > 0.0 else WAITING), 0.0, 0.0
    elif state[PHASE] == MILLING:
        _note(state, settings, resultant, phase)
        return _mill(state, settings, feed)
    return False


@njit(cache=True, nogil=True)
def run(  # type: ignore[no-untyped-def]
    number, start, stop, lift, feed, resultant, phase, holding,
    place, direction, is_running, is_finished, is_resting, duration, force_deviation, state, places, settings,
):  # fmt: skip
    """Run one frame; signals as the ports of `SegmentMove`."""
    for n in range(len(number)):
        seen = number[n, 0], lift[n, 0], feed[n, 0], resultant[n, 0], phase[n, 0], holding[n, 0]
        ended = _step(seen, start[n], stop[n], state, places, settings)
        part = state[PLACE] / state[LENGTH] if state[LENGTH] > 0.0 else 0.0
        for r in range(3):
            place[n, r] = places[FROM, r] + part * (places[TO, r] - places[FROM, r])
        long = math.hypot(places[STOP, 0] - places[START, 0], places[STOP, 1] - places[START, 1])
        for r in range(2):
            direction[n, r] = (places[STOP, r] - places[START, r]) / long if long > 0.0 else 1.0 - r
        is_running[n, 0] = 1.0 if state[PHASE] == MILLING else 0.0
        is_finished[n, 0] = 1.0 if ended else 0.0
        is_resting[n, 0] = 1.0 if state[PHASE] == WAITING else 0.0
        duration[n, 0] = state[DURATION]
        spread = state[SQUARES] / (state[COUNT] - 1.0) if state[COUNT] > 1.0 else 0.0
        force_deviation[n, 0] = math.sqrt(max(spread, 0.0))
