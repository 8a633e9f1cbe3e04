"""Where a vibrator's modal frequencies are as time passes: each swings, all may drift together, one may wander off."""

import numpy as np

from firmware_sim.plants.vibrator_modes import Modes
from firmware_sim.plants.vibrator_options import VibratorOptions

DRIFT_PERIODS = (600.0, 2400.0)
"""s, of the slow swing of each mode's frequency."""
FARTHEST = 30.0
"""Hz between a mode and where it was said to be."""


class ModalDrift:
    """A vibrator's modal frequencies at any time; at the start each is as drawn.

    Parameters
    ----------
    modes : Modes
    options : VibratorOptions
    rng : Generator
        Draws pace and phase of each mode's swing.

    Raises
    ------
    ValueError : no mode is near `moving_mode`.
    """

    def __init__(self, modes: Modes, options: VibratorOptions, rng: np.random.Generator) -> None:
        count = len(modes.frequency)
        self._drawn, self._options = modes.frequency, options
        self._pace = 2 * np.pi / rng.uniform(*DRIFT_PERIODS, count)
        self._phase = rng.uniform(0, 2 * np.pi, count)
        self._frequency = modes.frequency.copy()
        self._moving = _nearest(modes.frequency, options.moving_mode)
        self._far = options.moving_widths * 2 * modes.damping[self._moving] * modes.frequency[self._moving]

    def at(self, seconds: float) -> np.ndarray:
        """Return the frequencies, shape (modes,), Hz, `seconds` after the start, in an array of its own."""
        now, options = self._frequency, self._options
        np.multiply(self._pace, seconds, out=now)
        now += self._phase
        np.sin(now, out=now)
        now -= np.sin(self._phase)
        now *= options.drift
        now += 1.0
        now *= self._drawn
        now *= 1.0 + options.trend * min(seconds / options.trend_seconds, 1.0)
        if options.moving_mode > 0 and seconds >= options.moving_at:
            past = seconds - options.moving_at
            now[self._moving] += self._far * (
                min(past / options.moving_seconds, 1.0) if options.moving_seconds else 1.0
            )
        return now


def _nearest(frequency: np.ndarray, wanted: float) -> int:
    nearest = int(np.argmin(np.abs(frequency - wanted)))
    if wanted > 0 and not abs(frequency[nearest] - wanted) <= FARTHEST:
        raise ValueError(
            f"simulator.options.moving_mode is {wanted:g} Hz, must be within {FARTHEST:g} Hz of a mode: "
            f"the nearest is at {frequency[nearest]:.1f} Hz"
        )
    return nearest
