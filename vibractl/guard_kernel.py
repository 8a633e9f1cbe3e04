"""The guard's compiled kernel: ramps, limits, fade and latch, a sample at a time over a whole frame."""

import math

import numpy as np

from rigkit.compiled import njit
from rigkit.flush_kernel import flushed
from rigkit.record import Record
from vibractl.config import Limits

FINITE, PEAK, SLEW, RMS = range(4)
WORKING, FADING, LATCHED = range(3)
"""Of `phase`."""

GUARD = np.dtype(
    [
        ("phase", "i8"),
        ("opening", "?"),  # whether the ramp goes up
        ("position", "i8"),  # samples into the ramp, or the fade
        ("count", "i8"),  # samples since prepare
        # bounds
        ("peak", "f8"),  # V
        ("slew", "f8"),  # V/s
        ("square", "f8"),  # V^2
        ("rate", "f8"),  # samples/s
        ("forget", "f8"),  # of the mean square
    ],
    align=True,
)
CHANNEL = np.dtype([("last", "f8"), ("mean", "f8"), ("faded", "f8")], align=True)
"""Of a drive: last output, V; mean square, V^2; output where a fade began, V."""


def set_up(guard: np.ndarray, limits: Limits, rate: float) -> np.ndarray:
    """Set a guard's bounds.

    Parameters
    ----------
    guard : array, shape (1,), of `GUARD`
    limits : Limits
    rate : float, samples/s

    Returns
    -------
    array, shape (samples,), 1
        The ramp's gains, from 0 to exactly 1.
    """
    ramp = max(1, math.ceil(limits.ramp * rate))
    gains = 0.5 - 0.5 * np.cos(np.pi * np.arange(ramp + 1) / ramp)
    gains[-1] = 1.0
    guard["peak"], guard["slew"], guard["square"], guard["rate"] = limits.peak, limits.slew, limits.rms**2, rate
    guard["forget"] = -math.expm1(-1.0 / (limits.rms_seconds * rate))
    return gains


@njit(cache=True, nogil=True)
def _broken(request: float, value: float, guard: Record, channel: Record) -> tuple[int, float, float]:
    """Return which limit a sample would break (-1: none), its value, and what is allowed."""
    peak, slew, square, rate, last = guard.peak, guard.slew, guard.square, guard.rate, channel.last
    mean = channel.mean + guard.forget * (value * value - channel.mean)
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
def _let_out(
    request: np.ndarray, output: np.ndarray, gain: float, guard: Record, channels: np.ndarray, latch: np.ndarray
) -> None:
    """Write one sample of every drive; if one breaks a limit, latch and start the fade."""
    for channel in range(request.size):
        output[channel] = request[channel] if gain == 1.0 else request[channel] * gain
        limit, value, allowed = _broken(request[channel], output[channel], guard, channels[channel])
        if limit >= 0:
            latch[0], latch[1], latch[2], latch[3], latch[4] = limit, channel, guard.count, value, allowed
            for each in range(channels.size):
                channels[each].faded = channels[each].last
            guard.phase, guard.position = FADING, 0
            return


@njit(cache=True, nogil=True)
def _advance(guard: Record, ramp: int) -> None:
    """Move the ramp by one sample."""
    if guard.phase == WORKING:
        if guard.opening and guard.position < ramp:
            guard.position += 1
        elif not guard.opening and guard.position > 0:
            guard.position -= 1
    elif guard.phase == FADING:
        guard.position += 1
        if guard.position == ramp:
            guard.phase = LATCHED


@njit(cache=True, nogil=True)
def _let_all_out(request: np.ndarray, output: np.ndarray, first: int, guard: Record, channels: np.ndarray) -> int:
    """Write samples of a guard that is fully open, as long as they keep the limits; return where that ends."""
    peak, slew, square = guard.peak, guard.slew, guard.square
    rate, forget = guard.rate, guard.forget
    for n in range(first, len(request)):
        for channel in range(request.shape[1]):
            value = request[n, channel]
            mean = channels[channel].mean
            step = abs(value - channels[channel].last) * rate
            if not (abs(value) <= peak and step <= slew and mean + forget * (value * value - mean) <= square):
                return n  # NaN keeps no limit either
        for channel in range(request.shape[1]):
            value = output[n, channel] = request[n, channel]
            mean = channels[channel].mean
            channels[channel].mean = flushed(mean + forget * (value * value - mean))
            channels[channel].last = value
        guard.count += 1
    return len(request)


@njit(cache=True, nogil=True)
def _run_sample(
    request: np.ndarray, output: np.ndarray, gains: np.ndarray, guard: Record, channels: np.ndarray, latch: np.ndarray
) -> None:
    """Run one sample: shape (width,) in and out, V."""
    ramp = gains.size - 1
    _advance(guard, ramp)
    if guard.phase == WORKING and guard.position > 0:
        _let_out(request, output, gains[guard.position], guard, channels, latch)
        if guard.phase == FADING:
            _advance(guard, ramp)
    for channel in range(len(request)):
        if guard.phase == FADING:
            output[channel] = channels[channel].faded * gains[ramp - guard.position]
        elif guard.phase == LATCHED or guard.position == 0:
            output[channel] = 0.0
        value = output[channel]
        mean = channels[channel].mean
        channels[channel].mean = flushed(mean + guard.forget * (value * value - mean))
        channels[channel].last = value
    guard.count += 1


@njit(cache=True, nogil=True)
def run(
    request: np.ndarray,
    output: np.ndarray,
    gains: np.ndarray,
    guards: np.ndarray,
    channels: np.ndarray,
    latch: np.ndarray,
) -> None:
    """Run one frame: shape (frames, width) in and out, V; `guards` is of one `GUARD`, `channels` shape (width,).

    `latch` gets the violation: limit, channel, sample, value, allowed.
    """
    guard = guards[0]
    ramp = gains.size - 1
    n = 0
    while n < len(request):
        if guard.phase == WORKING and guard.opening and guard.position == ramp:
            n = _let_all_out(request, output, n, guard, channels)
            if n == len(request):
                return
        _run_sample(request[n], output[n], gains, guard, channels, latch)
        n += 1
