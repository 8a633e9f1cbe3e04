"""Where in a recording of any length a known signal lies, to a sample: searched stretch by stretch."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft

STRETCH = 2**20
"""Samples that are searched at once, or twice as many as the signal has."""
FAINT = 1e-12
"""Part of the loudest place's power below which rounding is all that is heard."""


@dataclass(frozen=True)
class Found:
    """Where a recording is most like a signal.

    Parameters
    ----------
    first : int, samples
        Where the signal would begin.
    likeness : float, 0 to 1
        Correlation there, over all channels, each with a gain of its own; 0 in a recording shorter than the signal.
    frames : int
        Of the recording.
    is_silent : bool
        Whether nothing was recorded.
    """

    first: int
    likeness: float
    frames: int
    is_silent: bool


def find(signal: np.ndarray, blocks: Iterable[np.ndarray], tell: Callable[[int], object] = lambda _: None) -> Found:
    """Find a signal in a recording, in memory for a few stretches of it.

    Parameters
    ----------
    signal : array, shape (length, channels), any unit
    blocks : iterable of arrays, shape (any number, channels), any unit
        The recording, in order.
    tell : callable(int)
        Called with how many samples have been searched, now and then.

    Returns
    -------
    Found
    """
    length, channels = signal.shape
    stretch = np.empty((max(STRETCH, next_fast_len(2 * length, real=True)), channels))
    likeness = _Likeness(signal)
    best, place, first, filled, frames, is_silent = 0.0, 0, 0, 0, 0, True
    for block in blocks:
        frames, is_silent = frames + len(block), is_silent and not block.any()
        while len(block):
            taken = block[: len(stretch) - filled]
            stretch[filled : filled + len(taken)] = taken
            filled, block = filled + len(taken), block[len(taken) :]
            if filled == len(stretch):
                found, at = likeness.most(stretch)
                best, place = (found, first + at) if found > best else (best, place)
                kept = length - 1
                stretch[:kept] = stretch[filled - kept :].copy()
                first, filled = first + filled - kept, kept
                tell(frames)
    if filled >= length:
        found, at = likeness.most(stretch[:filled])
        best, place = (found, first + at) if found > best else (best, place)
    return Found(place, best, frames, is_silent)


class _Likeness:
    """How like a signal a stretch is, at every place where the signal fits into it."""

    def __init__(self, signal: np.ndarray) -> None:
        self._signal, self._spectra = signal, np.zeros((0, 0), complex)
        self._size = (signal**2).sum(axis=0)
        self._points = 0

    def most(self, stretch: np.ndarray) -> tuple[float, int]:
        """Return the largest correlation and the first sample of its place; stretch (frames, channels)."""
        points, length = next_fast_len(len(stretch), real=True), len(self._signal)
        if points != self._points:
            self._points, self._spectra = points, np.conj(rfft(self._signal, points, axis=0))
        found = len(stretch) - length + 1
        explained, power = np.zeros(found), np.zeros(found)
        for channel, size in enumerate(self._size):
            heard = np.ascontiguousarray(stretch[:, channel])
            if size > 0:
                cross = irfft(rfft(heard, points) * self._spectra[:, channel], points)[:found]
                explained += cross**2 / size
            energy = np.concatenate(([0.0], np.cumsum(heard**2)))
            power += energy[length:] - energy[:found]
        least = FAINT * max(float(power.max()), np.finfo(float).tiny)
        explained /= np.maximum(power, least, out=power)
        at = int(explained.argmax())
        return float(np.sqrt(min(explained[at], 1.0))), at
