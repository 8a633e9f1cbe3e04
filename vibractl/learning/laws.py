"""The laws of the vibrator: by which drive each begins, and how the next one follows from a shot."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from rigkit.learning_law import LearningLaw

if TYPE_CHECKING:
    from vibractl.learning.belief import Belief

SIGNIFICANT = 0.5
"""A line belongs to the reference's own band where its spectrum is above this part of the largest."""


@dataclass(frozen=True, eq=False)
class Plant:
    """What is known of the vibrator before the first shot.

    Parameters
    ----------
    response : complex array, shape (lines, outputs, inputs), m/s^2 per V
        G.
    inverse : complex array, shape (lines, inputs, outputs), V per m/s^2
        G^+.
    reference : complex array, shape (lines, outputs), m/s^2 s
        R.
    """

    response: np.ndarray
    inverse: np.ndarray
    reference: np.ndarray


@dataclass(frozen=True, eq=False)
class Heard:
    """A shot that is learned from.

    Parameters
    ----------
    drive : complex array, shape (lines, inputs), V s
        U that it was made with.
    error : complex array, shape (lines, outputs), m/s^2 s
        R - Y.
    gain : array, shape (lines,), 1
        Q2: how much of the error is to be taken away.
    is_open : array, shape (lines,), 1
        0 on lines whose drive stays.
    """

    drive: np.ndarray
    error: np.ndarray
    gain: np.ndarray
    is_open: np.ndarray


class VibratorLaw(LearningLaw[Plant, "Belief", Heard, np.ndarray], Protocol):
    """Asks for drives, complex array of shape (lines, inputs), V s: U <- Q1 U + Q2 L E, by which bounds are computed.

    Attributes
    ----------
    keep : float, 1
        Q1.
    """

    keep: float

    def learns(self, belief: "Belief") -> np.ndarray:
        """Return L, complex, shape (lines, inputs, outputs), V per m/s^2."""


class ByInverse:
    """Begins with G^+ R; the next drive takes the error away as what is believed of the vibrator says.

    Source
    ------
    Sörnmo 2015, eq. (6.16).
    """

    keep = 1.0

    def first(self, model: Plant) -> np.ndarray:
        """Return G^+ R, shape (lines, inputs), V s."""
        solved: np.ndarray = (model.inverse @ model.reference[..., None])[..., 0]
        return solved

    def next(self, belief: "Belief", trial: Heard) -> np.ndarray:
        """Return U + Q2 G^+ E, shape (lines, inputs), V s, with what the modes will do until then."""
        return belief.next_drive(trial.drive, trial.error, trial.gain, trial.is_open)

    def learns(self, belief: "Belief") -> np.ndarray:
        """Return G^+, shape (lines, inputs, outputs), V per m/s^2."""
        return belief.inverse


class ByScaledReference(ByInverse):
    """Begins with the reference itself, scaled; the next drives are those of `ByInverse`.

    Source
    ------
    Sörnmo 2015, Algorithm 1.
    """

    def first(self, model: Plant) -> np.ndarray:
        """Return R over the plant's typical size in its band, shape (lines, inputs), V s: no model of shape is used."""
        band = strong_lines(model.reference)
        typical = np.median(np.linalg.norm(model.response[band], axis=1), axis=0)
        inputs, wanted = model.response.shape[2], model.reference
        share = wanted if inputs == wanted.shape[1] else wanted.mean(axis=1, keepdims=True)
        start: np.ndarray = share / typical
        return start


def strong_lines(reference: np.ndarray) -> np.ndarray:
    """Return which lines are the reference's own, bool (lines,): large at any of its outputs, (lines, outputs)."""
    size = np.abs(reference).max(axis=1)
    strong: np.ndarray = size > SIGNIFICANT * size.max()
    return strong
