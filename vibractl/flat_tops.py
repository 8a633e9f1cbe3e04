"""Flat tops: a sensor or an amplifier that goes no further, below the full scale of any converter."""

import numpy as np
from scipy.ndimage import uniform_filter1d

CLOSE = 0.003
"""1, of the largest deflection: what is nearer to it lies on a flat top ..."""
NOISE = 6.0
"""... or nearer than so many times the rms of the noise."""
SMOOTHED = 9
"""Samples that are averaged, against noise: 0.2 ms at 44.1 kHz."""
WIDE = 10.0
"""Times as near: what is counted beside it."""
SHARE = 0.7
"""Of those samples that lie on the top, at least.  Around the peak of a sine it is 1 / sqrt(WIDE) = 0.32, around the
flattest that a third overtone can make of it WIDE^(-1/4) = 0.56; a sine that is cut off 5 % below its peak has 0.8."""
TOPS = 4
"""Deflections that end there, at least."""
_MAD = 0.6745
"""Median size of a normal variable of rms 1."""


def flat_top(signal: np.ndarray) -> tuple[float, int] | None:
    """Find the value that a signal does not pass, though it comes from well below again and again.

    Parameters
    ----------
    signal : array, shape (samples,), any unit
        Much slower than its sampling rate; finite.

    Returns
    -------
    value : float, the signal's unit
        Where the tops are.
    count : int
        How many there are.  None for a signal whose largest deflections have the tops of vibrations, or that has more
        noise than a flat top could be told in.

    Examples
    --------
    >>> tone = np.sin(2 * np.pi * 40.0 * np.arange(44_100) / 44_100)
    >>> flat_top(tone)
    >>> flat_top(np.clip(tone, -0.75, 2.0))[1]
    40
    """
    if len(signal) < SMOOTHED:
        return None
    middle = float(np.median(signal))
    noise = float(np.median(np.abs(np.diff(signal, 2)))) / (_MAD * np.sqrt(6.0 * SMOOTHED))
    smooth = uniform_filter1d(np.asarray(signal - middle, dtype=float), SMOOTHED)
    for sign in (1.0, -1.0):
        away = sign * smooth
        top = float(away.max())
        close = max(CLOSE * top, NOISE * noise)
        if top <= 0 or WIDE * close > 0.5 * top:
            continue
        beside, on = away >= top - WIDE * close, away >= top - close
        if on.sum() < SHARE * beside.sum():
            continue
        starts = np.flatnonzero(np.diff(beside.astype(np.int8), prepend=0) == 1)
        count = int(np.logical_or.reduceat(on, starts).sum())
        if count >= TOPS:
            return middle + sign * float(np.median(away[on])), count
    return None
