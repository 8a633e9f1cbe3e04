"""A signal found near a place in a stretch of a recording, and one moved to a place."""

import numpy as np
from scipy.interpolate import make_interp_spline

from vibractl.foreign.search import Likeness
from vibractl.foreign.timing import ORDER, Timing, timing

PLATEAU = 1e-4
"""Of the energy of a drive: a window that holds as much but for this is as good."""
LOPSIDED = 0.1
"""Part of half the width of that plateau, by which its middle is off: a drive begins and ends with other amplitudes."""
STILL = 1e-3
"""samples: a signal that is to be moved by less is left as it is."""


def found_near(
    template: np.ndarray, stretch: np.ndarray, rate: float, at: int, reach: int
) -> tuple[Timing, np.ndarray]:
    """Find a signal in a stretch.

    Parameters
    ----------
    template : array, shape (frames, channels), any unit
    stretch : array, shape (samples, channels), any unit
    rate : float, samples/s
    at, reach : int, samples
        Where it begins, and by how much that may be wrong.

    Returns
    -------
    Timing
        In the stretch.
    array, shape (frames + at most 2 reach, channels)
        The part that was searched.
    """
    first = min(max(at - reach, 0), len(stretch) - len(template))
    part = stretch[first : at + len(template) + reach]
    _, best = Likeness(template).most(part)
    return timing(template, stretch, rate, float(first + best)), part


def loudest(drive: np.ndarray, frames: int, at: int, reach: int) -> tuple[float, float]:
    """Return where the frames begin that hold most of a drive's energy, as it lasts as long as the reference does.

    Parameters
    ----------
    drive : array, shape (samples, drives), V
    frames : int, samples
    at, reach : int, samples
        Where that is about, and by how much it may be wrong.

    Returns
    -------
    float, float, samples
        Where, and by how much it may still be wrong.
    """
    energy = np.concatenate(([0.0], np.cumsum((drive**2).sum(axis=1))))
    held = energy[frames:] - energy[:-frames]
    first = max(at - reach, 0)
    near = held[first : at + reach + 1]
    best = np.flatnonzero(near >= (1 - PLATEAU) * near.max())
    low, high = float(best[0]), float(best[-1])
    return first + (low + high) / 2, LOPSIDED * (high - low) / 2


def moved(signal: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return a signal between its samples.

    Parameters
    ----------
    signal : array, shape (samples, channels), any unit
    at : array, shape (wanted,), samples
        Where; silence stands for what is outside.

    Returns
    -------
    array, shape (wanted, channels), the same unit
    """
    last = len(signal) - 1
    inside = (at > -1) & (at < last + 1)
    found: np.ndarray = make_interp_spline(np.arange(last + 1), signal, k=ORDER)(np.clip(at, 0, last))
    return np.where(inside[:, None], found, 0.0)
