"""Natural frequencies and damping ratios of a sampled system's poles."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Modes:
    """One entry a mode: a real pole, or a pair of conjugate ones.

    Parameters
    ----------
    pole : complex array, shape (modes,), 1
        Discrete; of a pair the one with positive imaginary part.
    frequency : array, shape (modes,), Hz, rising
        Undamped natural frequency |s| / (2 pi) of the continuous pole s = rate ln(pole); infinite for a pole at zero.
    damping : array, shape (modes,), 1
        Damping ratio -Re s / |s|: 1 for a decaying real pole, negative for an unstable one.
    """

    pole: np.ndarray
    frequency: np.ndarray
    damping: np.ndarray


def modes(poles: np.ndarray, rate: float) -> Modes:
    """Describe discrete poles as modes.

    Parameters
    ----------
    poles : complex array, shape (n,), 1
        Conjugates in pairs.
    rate : float, samples/s

    Examples
    --------
    >>> s = 2 * np.pi * 50 * (-0.02 + 1j * np.sqrt(1 - 0.02**2))
    >>> found = modes(np.exp(np.array([s, np.conj(s)]) / 1000), 1000.0)
    >>> float(found.frequency[0].round(6)), float(found.damping[0].round(6))
    (50.0, 0.02)
    """
    upper = np.asarray(poles, complex)
    upper = upper[upper.imag >= 0]
    frequency, damping = frequency_and_damping(upper, rate)
    order = np.argsort(frequency, kind="stable")
    return Modes(upper[order], frequency[order], damping[order])


def frequency_and_damping(poles: np.ndarray, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the natural frequency, Hz, and the damping ratio of each pole by itself: shapes (poles,).

    Parameters
    ----------
    poles : complex array, shape (poles,), 1
    rate : float, samples/s
    """
    alive = np.abs(poles) > np.finfo(float).tiny
    continuous = rate * np.log(np.where(alive, poles, 1.0))
    speed = np.abs(continuous)
    damping = np.ones(len(poles))
    np.divide(-continuous.real, speed, out=damping, where=alive & (speed > 0))
    damping[alive & (speed == 0)] = 0.0  # an integrator neither decays nor grows
    return np.where(alive, speed / (2 * np.pi), np.inf), damping
