"""The compiled kernel of faults on purpose, a sample at a time over a whole frame."""

import math

import numpy as np
from numba import njit

NONE, STUCK, NAN, INF, ZERO, FULL_SCALE, TIMES_TEN, SIGN_FLIP, SWAP, DELAY, DROP, CLOCK, HUM = range(13)
KIND, PARTNER = range(2)
"""Columns of `table`."""
LATE = 0.01
"""s, of a delay."""
LOST = 0.01
"""Part of the samples, of a drop."""
DRIFT = 1e-4
"""s/s, of a clock."""
MAINS, LOUD = 50.0, 0.01
"""Hz and part of full scale, of a hum."""


@njit(cache=True, nogil=True)
def _uniform(random):  # type: ignore[no-untyped-def]
    """Return a number from 0 to 1, and move `random` on: Knuth's linear congruential generator, MMIX."""
    random[0] = random[0] * np.uint64(6364136223846793005) + np.uint64(1442695040888963407)
    return float(random[0] >> np.uint64(11)) / 2.0**53


@njit(cache=True, nogil=True)
def _earlier(ring, place, lag, channel):  # type: ignore[no-untyped-def]
    """Return what came `lag` samples ago, between two samples by a straight line; 0 before there was anything."""
    whole = int(lag)
    part = lag - whole
    near = ring[(place - whole) % len(ring), channel] if place >= whole else 0.0
    far = ring[(place - whole - 1) % len(ring), channel] if place >= whole + 1 else 0.0
    return near + part * (far - near)


@njit(cache=True, nogil=True)
def _spoiled(kind, value, channel, partner, clean, held, lag, ring, place, random, rate, full):  # type: ignore[no-untyped-def]
    """Return what becomes of one sample."""
    if kind == STUCK:
        return held[channel]
    if kind == NAN:
        return math.nan
    if kind == INF:
        return math.inf
    if kind == ZERO:
        return 0.0
    if kind == FULL_SCALE:
        return full[channel]
    if kind == TIMES_TEN:
        return 10.0 * value
    if kind == SIGN_FLIP:
        return -value
    if kind == SWAP:
        return clean[partner]
    if kind == DELAY:
        return _earlier(ring, place, float(round(LATE * rate)), channel)
    if kind == DROP:
        if _uniform(random) < LOST:
            return held[channel]
        held[channel] = value
        return value
    if kind == CLOCK:
        lag[channel] = min(lag[channel] + DRIFT, len(ring) - 2.0)
        return _earlier(ring, place, lag[channel], channel)
    if kind == HUM:
        return value + LOUD * full[channel] * math.sin(2.0 * math.pi * MAINS * place / rate)
    return value


@njit(cache=True, nogil=True)
def run(clean, faulty, table, running, held, lag, ring, place, random, rate, full):  # type: ignore[no-untyped-def]
    """Run one frame: shape (frames, width) in and out; every state begins anew when a channel's kind changes."""
    for n in range(len(clean)):
        ring[place[0] % len(ring)] = clean[n]
        for channel in range(clean.shape[1]):
            kind, partner = int(table[channel, KIND]), int(table[channel, PARTNER])
            if kind != running[channel]:
                running[channel], lag[channel], held[channel] = kind, 0.0, clean[n, channel]
            faulty[n, channel] = _spoiled(
                kind, clean[n, channel], channel, partner, clean[n], held, lag, ring, place[0], random, rate, full
            )
        place[0] += 1
