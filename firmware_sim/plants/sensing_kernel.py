"""From an acceleration to what a sensor says of it: a delay with a fraction of a sample, its resonance, its bend."""

import numpy as np

from firmware_sim.plants.flush_kernel import flushed
from rigkit.compiled import njit

LONGEST = 48
"""Taps of the interpolator."""
BETA = 8.0
"""Of its Kaiser window: the error is below -80 dB up to 0.4 of the rate."""


def interpolator(delay: float) -> tuple[int, np.ndarray]:
    """Return a delay as whole samples and the taps behind them, shape (taps,), 1.

    Parameters
    ----------
    delay : float, samples, >= 1

    Source
    ------
    Laakso, Valimaki, Karjalainen and Laine, Splitting the unit delay, IEEE Signal Processing Magazine 13 (1996) 30:
    the windowed ideal interpolator.
    """
    taps = min(LONGEST, 2 * int(delay))
    whole = int(delay) - taps // 2 + 1
    place = np.arange(taps) - (delay - whole)
    window = np.i0(BETA * np.sqrt(np.maximum(1 - (2 * place / taps) ** 2, 0.0))) / np.i0(BETA)
    shaped = np.sinc(place) * window
    return whole, shaped / shaped.sum()


def resonance(frequency: float, damping: float, rate: float) -> np.ndarray:
    """Return b0, b1, b2, a1, a2 of a sensor w^2 / (s^2 + 2 zeta w s + w^2), shape (5,), exact at 0 and at resonance.

    Parameters
    ----------
    frequency : float, Hz, below half the rate; 0 for a sensor that follows at once
    damping : float, 1
    rate : float, samples/s
    """
    if frequency == 0.0:
        return np.array([1.0, 0.0, 0.0, 0.0, 0.0])
    warped = 1 / np.tan(np.pi * frequency / rate)
    first, second = 2 * damping * warped, warped**2
    whole = second + first + 1
    row: np.ndarray = np.array([1.0, 2.0, 1.0, 2 * (1 - second), second - first + 1]) / whole
    return row


@njit(cache=True, nogil=True)
def run_sensors(
    heard: np.ndarray,
    past: np.ndarray,
    place: int,
    whole: np.ndarray,
    taps: np.ndarray,
    filters: np.ndarray,
    memory: np.ndarray,
    bend: np.ndarray,
) -> int:
    """Turn `heard` (frames, sensors) m/s^2 from accelerations into what the sensors say, in place; return the place.

    `past` (sensors, length) is a ring whose length is a power of two, `place` where the next sample goes; `whole`
    (sensors,) and `taps` (sensors, taps) the delays; `filters` (sensors, 5) and `memory` (sensors, 2) the resonances;
    `bend` (sensors, 2) what is added per square and cube, 1/(m/s^2) and 1/(m/s^2)^2.
    """
    mask = past.shape[1] - 1
    for n in range(heard.shape[0]):
        for s in range(heard.shape[1]):
            past[s, place] = flushed(heard[n, s])
            total, first = 0.0, place - whole[s]
            for tap in range(taps.shape[1]):
                total += taps[s, tap] * past[s, (first - tap) & mask]
            shaped = filters[s, 0] * total + memory[s, 0]
            memory[s, 0] = flushed(filters[s, 1] * total - filters[s, 3] * shaped + memory[s, 1])
            memory[s, 1] = flushed(filters[s, 2] * total - filters[s, 4] * shaped)
            heard[n, s] = shaped + (bend[s, 0] + bend[s, 1] * shaped) * shaped * shaped
        place = (place + 1) & mask
    return place
