"""Whether a signal repeats itself exactly, as one does that was laid down before anything was measured."""

from collections.abc import Sequence

import numpy as np

EXACT = 1e-10
"""Power of the difference between periods, of the signal's: rounding, and no more."""
SEEN = 0.25
"""Of a record: how much more than a period has to be there.  Of a signal's power: how much both of the parts that
repeat must have; rest at both ends of a record is no period."""


def periodic(records: Sequence[np.ndarray]) -> np.ndarray:
    """Return which channels repeat themselves, in every record that is long enough to show it.

    Parameters
    ----------
    records : sequence of arrays, each of shape (N, m), any unit

    Returns
    -------
    array of bool, shape (m,)

    Examples
    --------
    >>> one, other = np.random.default_rng(1).standard_normal((2, 50))
    >>> periodic([np.column_stack([np.tile(one, 4), np.concatenate([one, other, one, other[::-1]])])]).tolist()
    [True, False]
    """
    channels = zip(*(each.T for each in records), strict=True)
    return np.array([_repeats([channel for channel in pieces if len(channel) > 1]) for pieces in channels])


def _repeats(pieces: Sequence[np.ndarray]) -> bool:
    longest = max(pieces, key=len, default=np.zeros(0))
    period = _period(longest)
    if period == 0:
        return False
    power = float(np.var(longest))
    long_enough = [piece for piece in pieces if len(piece) * (1 - SEEN) > period]
    return all(_repeats_after(piece, period, power) for piece in long_enough)


def _repeats_after(signal: np.ndarray, period: int, power: float) -> bool:
    early, late = signal[:-period], signal[period:]
    moves = min(float(np.var(early)), float(np.var(late))) > SEEN * power
    return moves and float(np.mean((late - early) ** 2)) < EXACT * power


def _period(signal: np.ndarray) -> int:
    """Return the lag of the largest correlation, samples; 0 for none."""
    last = int((1 - SEEN) * len(signal))
    if last < 3 or not signal.any():
        return 0
    spectrum = np.fft.rfft(signal - signal.mean(), 2 * len(signal))
    correlation = np.fft.irfft(np.abs(spectrum) ** 2)[:last] / (len(signal) - np.arange(last))
    falls = np.flatnonzero(correlation < 0.5 * correlation[0])  # a slow signal is like itself a sample later
    return int(falls[0] + correlation[falls[0] :].argmax()) if len(falls) else 0
