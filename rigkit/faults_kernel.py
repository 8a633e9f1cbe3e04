"""The compiled kernel of faults on purpose, a sample at a time over a whole frame."""

import math

import numpy as np

from rigkit.compiled import njit
from rigkit.record import Record

NONE, STUCK, NAN, INF, ZERO, FULL_SCALE, TIMES_TEN, SIGN_FLIP, SWAP, DELAY, DROP, CLOCK, HUM = range(13)
"""What a channel has."""
LATE = 0.01
"""s, of a delay."""
LOST = 0.01
"""Part of the samples, of a drop."""
DRIFT = 1e-4
"""s/s, of a clock."""
MAINS, LOUD = 50.0, 0.01
"""Hz and part of full scale, of a hum."""

CHANNEL = np.dtype(
    [
        ("kind", "f8"),  # in shared memory: of a single type
        ("partner", "f8"),  # the channel that is swapped with it
    ],
    align=True,
)
STATE = np.dtype(
    [
        ("running", "i8"),  # the kind that it has had
        ("held", "f8"),  # the value at its beginning, or the last one
        ("lag", "f8"),  # samples, of a clock
        ("full", "f8"),  # full scale
    ],
    align=True,
)
"""Of one channel."""
PROGRESS = np.dtype([("place", "i8"), ("random", "u8"), ("rate", "f8")], align=True)
"""Samples so far, the state of what is drawn, and samples/s."""


@njit(cache=True, nogil=True)
def _uniform(clock: Record) -> float:
    """Return a number from 0 to 1, and move it on: Knuth's linear congruential generator, MMIX."""
    random = clock.random * np.uint64(6364136223846793005) + np.uint64(1442695040888963407)
    clock.random = random
    return float(random >> np.uint64(11)) / 2.0**53


@njit(cache=True, nogil=True)
def _earlier(ring: np.ndarray, place: int, lag: float, channel: int) -> float:
    """Return what came `lag` samples ago, between two samples by a straight line; 0 before there was anything."""
    whole = int(lag)
    part = lag - whole
    near = ring[(place - whole) % len(ring), channel] if place >= whole else 0.0
    far = ring[(place - whole - 1) % len(ring), channel] if place >= whole + 1 else 0.0
    return float(near + part * (far - near))


@njit(cache=True, nogil=True)
def _spoiled(channel: int, partner: int, clean: np.ndarray, state: Record, ring: np.ndarray, clock: Record) -> float:
    """Return what becomes of one sample."""
    kind, value, place = state.running, clean[channel], clock.place
    if kind == STUCK:
        return float(state.held)
    if kind == NAN:
        return math.nan
    if kind == INF:
        return math.inf
    if kind == ZERO:
        return 0.0
    if kind == FULL_SCALE:
        return float(state.full)
    if kind == TIMES_TEN:
        return float(10.0 * value)
    if kind == SIGN_FLIP:
        return float(-value)
    if kind == SWAP:
        return float(clean[partner])
    if kind == DELAY:
        return _earlier(ring, place, float(round(LATE * clock.rate)), channel)
    if kind == DROP:
        if not _uniform(clock) < LOST:
            state.held = value
        return float(state.held)
    if kind == CLOCK:
        state.lag = min(state.lag + DRIFT, len(ring) - 2.0)
        return _earlier(ring, place, state.lag, channel)
    if kind == HUM:
        return float(value + LOUD * state.full * math.sin(2.0 * math.pi * MAINS * place / clock.rate))
    return float(value)


@njit(cache=True, nogil=True)
def run(
    clean: np.ndarray, faulty: np.ndarray, table: np.ndarray, states: np.ndarray, ring: np.ndarray, clocks: np.ndarray
) -> None:
    """Run one frame: shape (frames, width) in and out; every state begins anew when a channel's kind changes.

    `table` and `states` are shape (width,), `ring` (samples, width) has what came before; `clocks`: one `PROGRESS`.
    """
    clock = clocks[0]
    for n in range(len(clean)):
        ring[clock.place % len(ring)] = clean[n]
        for channel in range(clean.shape[1]):
            kind, state = int(table[channel].kind), states[channel]
            if kind != state.running:
                state.running, state.lag, state.held = kind, 0.0, clean[n, channel]
            faulty[n, channel] = _spoiled(channel, int(table[channel].partner), clean[n], state, ring, clock)
        clock.place += 1
