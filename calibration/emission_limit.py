"""What may be emitted at each line of a steady signal, so that no shot's worth of it is over the objective."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import maximum_filter1d

from vibractl.config import RigConfig
from vibractl.decibels import decibels
from vibractl.judging import Judging
from vibractl.quality import Judge

GUARD = 10.0
"""Hz below `quality.above` from where the limit holds, for what rises and falls spreads so far."""

AMBIENCE, AROUND = 1.5, 2
"""Times the largest line of the silence, so many bins around, that ambience alone is reckoned to reach."""


@dataclass(frozen=True)
class EmissionLimit:
    """Amplitudes of lines, m/s^2.

    Parameters
    ----------
    tone : float, m/s^2
        Of a steady tone whose line, over a shot's reference, is at the objective, on the side where that is least.
    objective : float, dB
        That is so far above the tone at the level of the reference's own lines.
    above : float, Hz
        From here on it must hold.
    seconds : float, s
        Of the reference: lines nearer to each other than its inverse add up.
    """

    tone: float
    objective: float
    above: float
    seconds: float

    @classmethod
    def of(cls, config: RigConfig) -> "EmissionLimit":
        """Return the limit that the objective of a rig's reference sets.

        Raises
        ------
        ValueError : the reference cannot be made.
        """
        judging = Judging.of(config)
        seconds = judging.shot.frames / judging.shot.rate
        tone = 2 * float(Judge(judging).limit.min()) / seconds
        return cls(tone, config.quality.objective, config.quality.above, seconds)

    def is_free(self, frequency: np.ndarray) -> np.ndarray:
        """Say for which lines there is no limit, (lines,) of bool.

        Parameters
        ----------
        frequency : array, shape (lines,), Hz
        """
        free: np.ndarray = frequency < self.above - GUARD
        return free

    def allowed(self, frequency: np.ndarray, low: float) -> np.ndarray:
        """Return the amplitude allowed to each of evenly spaced lines, (lines,), m/s^2.

        Parameters
        ----------
        frequency : array, shape (lines,), Hz
        low : float, dB
            Re the reference's own lines, of lines for which there is no limit.
        """
        spacing = (frequency[-1] - frequency[0]) / max(len(frequency) - 1, 1)
        together = max(1.0, 1.0 / (self.seconds * spacing)) if spacing > 0 else 1.0
        share = np.where(self.is_free(frequency), 10 ** ((low - self.objective) / 20), 1.0)
        allowed: np.ndarray = self.tone / np.sqrt(together) * share
        return allowed

    def over(self, frequency: np.ndarray, heard: np.ndarray, silence: np.ndarray) -> float:
        """Return by how much the largest of evenly spaced lines from `above` on is over the limit, dB.

        Of what is heard the ambience is no emission: where it may explain a line, nothing is counted.

        Parameters
        ----------
        frequency : array, shape (lines,), Hz
        heard : array, shape (records, lines, outputs), m/s^2
        silence : array, shape (lines, outputs), m/s^2
            Amplitudes without a drive.
        """
        emitted = np.sqrt(np.maximum(np.abs(heard) ** 2 - _ambience(silence) ** 2, 0.0))
        holds = frequency >= self.above
        over = emitted[:, holds] / self.allowed(frequency, 0.0)[holds, None]
        return float(decibels(over.max(initial=0.0)))


def _ambience(silence: np.ndarray) -> np.ndarray:
    """Return the amplitudes that ambience alone is reckoned to reach, (lines, outputs), m/s^2."""
    largest: np.ndarray = maximum_filter1d(np.abs(silence), 2 * AROUND + 1, axis=0, mode="nearest")
    return AMBIENCE * largest
