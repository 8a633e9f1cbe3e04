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
    likeness = Likeness(signal)
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


class Likeness:
    """How like a signal a stretch is, at every place where the signal fits into it.

    Parameters
    ----------
    signal : array, shape (length, channels), any unit
    """

    def __init__(self, signal: np.ndarray) -> None:
        self._signal, self._spectra = signal, np.zeros((0, 0), complex)
        self._size = (signal**2).sum(axis=0)
        self._points = 0

    def most(self, stretch: np.ndarray) -> tuple[float, int]:
        """Return the largest correlation and the first sample of its place; stretch (frames, channels)."""
        everywhere = self.everywhere(stretch)
        at = int(everywhere.argmax())
        return float(everywhere[at]), at

    def everywhere(self, stretch: np.ndarray) -> np.ndarray:
        """Return the correlation over all channels, each with a gain of its own, for each sample that may be the first.

        Parameters
        ----------
        stretch : array, shape (at least length, channels), any unit

        Returns
        -------
        array, shape (places,), 0 to 1
        """
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
        like: np.ndarray = np.sqrt(np.minimum(explained, 1.0, out=explained), out=explained)
        return like


def correlations(signal: np.ndarray, recorded: np.ndarray) -> np.ndarray:
    """Return the correlation of a signal with each channel of a recording, wherever in it the signal may begin.

    Parameters
    ----------
    signal : array, shape (length,), any unit
    recorded : array, shape (at least length, channels), any unit

    Returns
    -------
    array, shape (places, channels), -1 to 1
    """
    length, found = len(signal), len(recorded) - len(signal) + 1
    points = next_fast_len(len(recorded), real=True)
    turned = np.conj(rfft(signal, points))[:, None]
    cross = irfft(rfft(recorded, points, axis=0) * turned, points, axis=0)[:found]
    energy = np.concatenate((np.zeros((1, recorded.shape[1])), np.cumsum(recorded**2, axis=0)))
    power = float(signal @ signal) * (energy[length:] - energy[:found])
    least = FAINT * max(float(power.max()), np.finfo(float).tiny)
    like: np.ndarray = np.clip(cross / np.sqrt(np.maximum(power, least)), -1.0, 1.0)
    return like
