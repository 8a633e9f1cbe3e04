"""How much is dared: the gain of each line, and the bounds on what it leaves of the error."""

import numpy as np

from vibractl.learning.belief import Belief
from vibractl.learning.disturbance import smoothed
from vibractl.learning.kinds_of_law import KINDS
from vibractl.learning.law import Law
from vibractl.learning.pace import Pace
from vibractl.learning.shot import Shot
from vibractl.transfer_matrix import contraction

DEVIATIONS = 2.0
"""Standard deviations that a bound allows for."""
NOISY = 2.0
"""Times the power of noise by which it alone makes the error of a line larger from shot to shot."""
CONFIDENCE = 0.97
"""Part of the lines whose last error should have been within its bound; bounds widen until it is."""


class Daring:
    """The gains of a run, and what they promise.

    Without caution a line's gain is that of the schedule, as in the thesis.

    Parameters
    ----------
    law : Law
    is_cautious : bool
        Learn less where the error is mostly noise, and at the strong lines the more distortion follows them, or where
        the error has grown.
    belief : Belief

    Attributes
    ----------
    updates : int
        Made so far: what the schedule of the gains counts.
    nominal : float, 1
        Gain of the schedule.
    gain : array, shape (lines,), 1
        Q2, at most `nominal`.
    is_open : array, shape (lines,), 1
        0 on lines that are frozen, or are not learned.
    certificate : array, shape (lines,), 1
        Bound on the norm of the error map, with the uncertainty of G.
    error_bound : array, shape (lines,), m/s^2 s
        How large the next error may be, with noise and the distortion that follows the strong lines.

    Source
    ------
    Sörnmo 2015, eq. (6.11), (6.18).
    """

    def __init__(self, law: Law, is_cautious: bool, belief: Belief) -> None:
        self._law, self._is_cautious, self._learned = law, is_cautious, law.active > 0
        self._by = KINDS[law.settings.law].law
        self.updates, self._widened, self._pace = 0, 1.0, Pace(len(law.active))
        self.is_open = law.active.copy()
        self.nominal = law.gains.at(0)
        self.gain = self.nominal * law.active
        self.certificate = self._certificate(belief)
        self.error_bound = self.certificate * np.linalg.norm(law.reference, axis=1)

    @property
    def computed_bound(self) -> np.ndarray:
        """`error_bound` without what it was widened by because earlier ones did not hold."""
        bound: np.ndarray = self.error_bound / self._widened
        return bound

    @property
    def expected(self) -> float:
        """How large the norm of the next error may be over the lines that are open, m/s^2 s."""
        return float(np.linalg.norm(self.error_bound[self.is_open > 0]))

    def freeze(self, lines: np.ndarray) -> None:
        """Learn on some lines, bool (lines,), no more."""
        self.is_open = np.where(lines, 0.0, self.is_open)

    def promise_nothing(self) -> None:
        """Begin the schedule anew, without a bound on the next error: that of another level."""
        self.updates, self.error_bound = 0, np.full_like(self.error_bound, np.inf)
        self._pace.forget()

    def choose(self, belief: Belief, shot: Shot, error: np.ndarray, pace: float) -> None:
        """Choose the gain of the coming update, and bound what it leaves.

        Parameters
        ----------
        belief : Belief
        shot : Shot
            To be learned from.
        error : complex array, shape (lines, outputs), m/s^2 s
            That it left.
        pace : float, 1
            Part of the schedule's gain.
        """
        self.nominal = self._law.gains.at(self.updates) * pace
        self.gain = self.nominal * self.is_open
        if self._is_cautious:
            self.gain = self.gain * self._caution(belief, shot, error)
        coming = belief.disturbance(shot, self.gain[:, None] * error)
        self.certificate = self._certificate(belief)
        size = np.linalg.norm(error, axis=1)
        left = self.certificate * size
        if self._by.keep != 1.0:  # what fades of the drive is missing from the response
            left = left + abs(1.0 - self._by.keep) * np.linalg.norm(shot.response, axis=1)
        self._widened = self._outcome(size) if self.updates else 1.0
        self.error_bound = self._widened * (left + DEVIATIONS * np.sqrt(coming))

    def _certificate(self, belief: Belief) -> np.ndarray:
        """Return the bound on the error map of the coming update, (lines,), 1."""
        learns = self._by.learns(belief)
        bound: np.ndarray = contraction(belief.response, belief.variance, learns, self.gain, DEVIATIONS)
        return bound

    def _caution(self, belief: Belief, shot: Shot, error: np.ndarray) -> np.ndarray:
        """Return the part of the schedule's gain that is dared at each line, (lines,).

        A step at the strong lines changes distortion everywhere, at themselves as well, and so takes less of the error
        the more of it will have changed.  At judged lines a distortion that has changed is there to be learned: it
        stays, and only noise is gone in the next shot.  Lines that do not count as much are learned as the strong ones
        are, for what is wrong there disturbs all others.  At tones an error that has grown says more of G than of
        haste.  A certificate below 1 says that errors shrink for all that G may be: one that has grown all the same has
        done so by a plant that drifts, and so has one that has grown by no more than the drift that is allowed for.
        """
        power = smoothed(np.abs(error) ** 2, belief.reach).sum(axis=1)
        noise = belief.noise(shot)
        chance = NOISY * smoothed(noise[:, None], belief.reach)[:, 0]
        drift = smoothed(belief.drifted(shot), belief.reach).sum(axis=1)
        self._pace.take(power, chance, drift, self.certificate >= 1.0)  # of the update that led to this shot
        careful = belief.strong | self._law.counts_less
        spoilt = np.where(careful, belief.disturbance(shot, self.nominal * error), noise)
        pace = np.where(careful & ~belief.tones, self._pace.part, 1.0)
        caution: np.ndarray = power / (power + spoilt) * pace
        return caution

    def _outcome(self, size: np.ndarray) -> float:
        """Return by how much bounds are to be wider than computed, from how the last one, (lines,), has held."""
        held = size[self._learned] / np.maximum(self.error_bound[self._learned], np.finfo(float).tiny)
        needed = self._widened * float(np.quantile(held, CONFIDENCE))
        return max(1.0, needed, (needed + self._widened) / 2)
