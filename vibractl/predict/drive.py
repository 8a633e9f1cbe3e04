"""Which drives a reference needs, and what room they leave under the guard's limits."""

from dataclasses import dataclass

import numpy as np

from vibractl.config import Limits
from vibractl.decibels import FAINT, decibels
from vibractl.learning.law import bounded_inverse
from vibractl.loudness import allowed_sizes, drive_sizes, too_loud
from vibractl.predict.plant import drawn_response
from vibractl.setup import Setup

DRAWS = 12
"""Of G, for the range of the drives."""
SEED = 21


@dataclass(frozen=True)
class DriveNeeds:
    """Drives as numbers: peak V, rms V and slew V/s, last axis, of each coil, the axis before.

    Parameters
    ----------
    needed : array, shape (coils, 3)
        By G^+ R.
    low, high : arrays, shape (coils, 3)
        10 and 90 % of what it may be, for all that the model says of G.
    first : array, shape (coils, 3)
        Of the first drive.
    learned : array, shape (coils, 3)
        90 % of the last drives of simulated runs: with what makes up for distortion.
    violation : str
        What the guard would say to the first drive or to G^+ R; empty if it lets both out.
    """

    needed: np.ndarray
    low: np.ndarray
    high: np.ndarray
    first: np.ndarray
    learned: np.ndarray
    violation: str

    def headroom(self, limits: Limits) -> np.ndarray:
        """Return the room (coils, 3) that the largest of these leaves under the limits, dB; infinite where silent."""
        largest = np.max([self.needed, self.high, self.first, self.learned], axis=0)
        return np.where(largest > 0, decibels(allowed_sizes(limits) / np.maximum(largest, FAINT)), np.inf)


def drive_needs(made: Setup, learned: np.ndarray) -> DriveNeeds:
    """Find the drives a reference needs, before anything is emitted.

    Parameters
    ----------
    made : Setup
    learned : complex array, shape (runs, lines, inputs), V s
        Last drives of simulated runs.

    Source
    ------
    Sörnmo 2015, eq. (6.16), (6.19): U = G^+ R.
    """
    law, limits, rate = made.law, made.config.limits, made.shot.rate
    rng = np.random.default_rng(SEED)
    wanted = _emitted(made, _answer(made, law.inverse))
    first = _emitted(made, made.law.start)
    drawn = [
        _sizes(_emitted(made, _answer(made, bounded_inverse(drawn_response(law.matrix, rng), law.settings))), made)
        for _ in range(DRAWS)
    ]
    low, high = np.quantile(drawn, [0.1, 0.9], axis=0)
    last = np.quantile([_sizes(_emitted(made, lines), made) for lines in learned], 0.9, axis=0)
    broken = next((found for each in (first, wanted) if (found := too_loud(each, limits, rate))), "")
    return DriveNeeds(_sizes(wanted, made), low, high, _sizes(first, made), last, broken)


def _answer(made: Setup, inverse: np.ndarray) -> np.ndarray:
    """Return G^+ R, (lines, inputs), V s, on the lines that are learned."""
    lines: np.ndarray = (inverse @ made.law.reference[..., None])[..., 0] * made.law.active[:, None]
    return lines


def _emitted(made: Setup, lines: np.ndarray) -> np.ndarray:
    """Return the drive while the reference lasts, (frames, coils), V, that a learner makes of lines (lines, inputs)."""
    return made.learner().rendered(lines).astype(float)


def _sizes(drive: np.ndarray, made: Setup) -> np.ndarray:
    return drive_sizes(drive, made.config.limits, made.shot.rate)
