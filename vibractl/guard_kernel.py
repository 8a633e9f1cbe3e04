"""The guard's compiled kernel: ramps, limits, fade and latch, a sample at a time over a whole frame."""

import math

import numpy as np
from numba import njit

from rigkit.flush_kernel import flushed
from vibractl.config import Limits

FINITE, PEAK, SLEW, RMS = range(4)
WORKING, FADING, LATCHED = range(3)
PHASE, OPENING, POSITION, COUNT = range(4)
"""Of `state`, whole numbers: phase, whether the ramp goes up, where it is, samples since prepare."""
_LAST, _MEAN, _FADED = range(3)
"""Rows of `memory`: last output, mean square, output where a fade began."""
ROWS = 3


def tables(limits: Limits, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the ramp's gains, from 0 to exactly 1, and the bounds: peak, slew, mean square, rate and forgetting."""
    ramp = max(1, math.ceil(limits.ramp * rate))
    gains = 0.5 - 0.5 * np.cos(np.pi * np.arange(ramp + 1) / ramp)
    gains[-1] = 1.0
    forget = -math.expm1(-1.0 / (limits.rms_seconds * rate))
    return gains, np.array([limits.peak, limits.slew, limits.rms**2, rate, forget])


@njit(cache=True, nogil=True)
def _broken(request, value, last, mean, bounds):  # type: ignore[no-untyped-def]
    """Return which limit a sample would break (-1: none), its value, and what is allowed."""
    peak, slew, square, rate, forget = bounds
    mean += forget * (value * value - mean)
    if not math.isfinite(request):
        return FINITE, request, math.inf
    if not abs(value) <= peak:
        return PEAK, value, peak
    if not abs(value - last) * rate <= slew:
        return SLEW, (value - last) * rate, slew
    if not mean <= square:
        return RMS, math.sqrt(mean), math.sqrt(square)
    return -1, 0.0, 0.0


@njit(cache=True, nogil=True)
def _let_out(request, output, gain, bounds, memory, state, latch):  # type: ignore[no-untyped-def]
    """Write one sample of every drive; if one breaks a limit, latch and start the fade."""
    for channel in range(request.size):
        output[channel] = request[channel] if gain == 1.0 else request[channel] * gain
        limit, value, allowed = _broken(
            request[channel], output[channel], memory[_LAST, channel], memory[_MEAN, channel], bounds
        )
        if limit >= 0:
            latch[0], latch[1], latch[2], latch[3], latch[4] = limit, channel, state[COUNT], value, allowed
            memory[_FADED, :] = memory[_LAST, :]
            state[PHASE], state[POSITION] = FADING, 0
            return


@njit(cache=True, nogil=True)
def _advance(state, ramp):  # type: ignore[no-untyped-def]
    """Move the ramp by one sample."""
    if state[PHASE] == WORKING:
        if state[OPENING] and state[POSITION] < ramp:
            state[POSITION] += 1
        elif not state[OPENING] and state[POSITION] > 0:
            state[POSITION] -= 1
    elif state[PHASE] == FADING:
        state[POSITION] += 1
        if state[POSITION] == ramp:
            state[PHASE] = LATCHED


@njit(cache=True, nogil=True)
def _let_all_out(request, output, first, bounds, memory, state):  # type: ignore[no-untyped-def]
    """Write samples of a guard that is fully open, as long as they keep the limits; return where that ends."""
    peak, slew, square, rate, forget = bounds
    for n in range(first, len(request)):
        for channel in range(request.shape[1]):
            value = request[n, channel]
            mean = memory[_MEAN, channel]
            step = abs(value - memory[_LAST, channel]) * rate
            if not (abs(value) <= peak and step <= slew and mean + forget * (value * value - mean) <= square):
                return n  # NaN keeps no limit either
        for channel in range(request.shape[1]):
            value = output[n, channel] = request[n, channel]
            mean = memory[_MEAN, channel]
            memory[_MEAN, channel] = flushed(mean + forget * (value * value - mean))
            memory[_LAST, channel] = value
        state[COUNT] += 1
    return len(request)


@njit(cache=True, nogil=True)
def _run_sample(request, output, gains, bounds, memory, state, latch):  # type: ignore[no-untyped-def]
    """Run one sample: shape (width,) in and out, V."""
    ramp = gains.size - 1
    _advance(state, ramp)
    if state[PHASE] == WORKING and state[POSITION] > 0:
        _let_out(request, output, gains[state[POSITION]], bounds, memory, state, latch)
        if state[PHASE] == FADING:
            _advance(state, ramp)
    for channel in range(len(request)):
        if state[PHASE] == FADING:
            output[channel] = memory[_FADED, channel] * gains[ramp - state[POSITION]]
        elif state[PHASE] == LATCHED or state[POSITION] == 0:
            output[channel] = 0.0
        value = output[channel]
        mean = memory[_MEAN, channel]
        memory[_MEAN, channel] = flushed(mean + bounds[4] * (value * value - mean))
        memory[_LAST, channel] = value
    state[COUNT] += 1


@njit(cache=True, nogil=True)
def run(request, output, gains, bounds, memory, state, latch):  # type: ignore[no-untyped-def]
    """Run one frame: shape (frames, width) in and out, V."""
    ramp = gains.size - 1
    n = 0
    while n < len(request):
        if state[PHASE] == WORKING and state[OPENING] and state[POSITION] == ramp:
            n = _let_all_out(request, output, n, bounds, memory, state)
            if n == len(request):
                return
        _run_sample(request[n], output[n], gains, bounds, memory, state, latch)
        n += 1
