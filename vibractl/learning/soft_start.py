"""A soft start: the reference begins faint, and rises as far as what is emitted beside it allows."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import median_filter

from vibractl.learning.decision import Decision, tidy
from vibractl.learning.disturbance import noise_reach, smoothed
from vibractl.learning.law import Law, reference_level
from vibractl.learning.shot import Shot

FAINT = 2.0
"""Level of the first shot over that at which the reference itself is as loud as the limit."""
TARGET = 0.7
"""Of the limit, that the loudest line is to come to at the next level: 3 dB below."""
BROKEN = 1.4
"""Of the limit, from which a level was too much: half of the rise is taken back."""
FAR = 3.0
"""Of the limit, from which all of it is."""
LARGER = 2.0
"""Times the present level, that the next one is at most; and times the last rise, that a rise is."""
MODEST = 0.1
"""Of the level: a rise that is allowed however small the last one was."""
ENOUGH = 0.5
"""Of the largest rise: what is worth a rise at once; less waits for what another shot learns."""
PATIENCE = 3
"""Shots of one level, from which a smaller rise will do; and twice as many, from which the smallest is tried."""
SMALLEST = 0.03
"""Of the level: a smaller rise is none, for the machine's own changes from shot to shot are larger."""
STEEPER = 2
"""By which power of the level what a rise brings grows: that of distortion over its slope."""
TRIED = 200
"""Rises."""
EASED = 0.5
"""Of what a rise was expected to bring, to which a single one that brought less makes that fall."""
LEARNED = 0.3
"""What the first update at a level is expected to leave of what the rise has brought."""
REACH = 2
"""Lines to each side over which noise in the drive is compared with what was learned."""
AROUND = 5
"""Lines to each side of which that noise is the median: what is doubted of a single line's hum does not count."""
BASE = 0.5
"""Of a rise: so far below, at least, lies the level by which its drive is predicted; nearer, noise is amplified."""
LEARNING = 0.7
"""What a later one is expected to leave at least, of what is left."""
ROUNDING = 1e-9
"""Below the full level, what is the full level."""

_TINY = float(np.finfo(float).tiny)


@dataclass(frozen=True)
class Emission:
    """The loudest of the judged lines.

    Parameters
    ----------
    over : float, 1
        Its size less what noise may be, re the limit.
    frequency : float, Hz
    """

    over: float
    frequency: float


class SoftStart:
    """The levels of a run that begins faint.

    The drive of the next level is the present one scaled, or lies on the line through it and one learned at a lower
    level, at least `BASE` of the rise below (a secant predictor), or between the two: by which the last level's would
    have been predicted best.  The learning at that level corrects it, as where a curve of solutions is continued.

    How far a level may rise goes by what the last rises have brought at the loudest judged line: in proportion, and
    steeper with the level, up to `TARGET` of the limit.

    Parameters
    ----------
    law : Law
    judged : bool array, shape (lines,)
        Lines for which the limit holds.
    objective : float, dB
        Of the limit, re the reference's level.

    Attributes
    ----------
    level : float, 1
        Of the next shot.
    has_fallen : bool
        All of the last rise was taken back: what was learned of G since is of another machine, or wrong.

    Source
    ------
    Allgower and Georg, Numerical Continuation Methods, 1990, ch. 2 and 6.
    """

    def __init__(self, law: Law, judged: np.ndarray, objective: float) -> None:
        least = 10 ** (objective / 20)
        self._judged, self._frequency = judged, law.matrix.frequency
        self._limit = reference_level(law.reference) * least
        self.level = min(1.0, FAINT * least)
        self._learned = [(0.0, np.zeros_like(law.start))]
        self._rise, self._rate, self._left, self._last, self._held = self.level, 0.0, 0.0, 0.0, 0
        self._predictions: tuple[np.ndarray, np.ndarray] | None = None
        self.has_fallen = False
        self._reach, self._has_risen = 0 if law.is_tonal else REACH, False

    @property
    def over(self) -> bool:
        """Whether the full level has been reached, and a shot of it was within the limit."""
        return self.level >= 1.0 and self._held > 0 and self._last <= 1.0

    def emission(self, error: np.ndarray, noise: np.ndarray) -> Emission:
        """Return how loud a shot was beside its reference.

        Parameters
        ----------
        error : complex array, shape (lines, outputs), m/s^2 s
        noise : array, shape (lines, outputs), (m/s^2 s)^2
            E |N|^2 in it.
        """
        count = max(1, int(self._judged.sum()) * error.shape[1])
        excess = np.maximum(np.abs(error) ** 2 - noise_reach(noise, count), 0.0) / self._limit**2
        loudest = np.where(self._judged, excess.max(axis=1), 0.0)
        place = int(loudest.argmax())
        return Emission(float(np.sqrt(loudest[place])), float(self._frequency[place]))

    def onward(
        self, shot: Shot, error: np.ndarray, learned: np.ndarray, noise: np.ndarray
    ) -> tuple[np.ndarray, Decision | None]:
        """Choose the level of the next shot; return its drive, and what was decided where that is another level.

        Parameters
        ----------
        shot : Shot
            The last one.
        error : complex array, shape (lines, outputs), m/s^2 s
            That it left of the reference at its level.
        learned : complex array, shape (lines, inputs), V s
            The next drive for the same level.
        noise : array, shape (lines, inputs), (V s)^2
            E |N|^2 in that.
        """
        heard, before = self.emission(error, shot.noise), self.level
        is_first, self._held = self._held == 0, self._held + 1
        if is_first:
            self._rate = max((heard.over - self._left) / self._rise, EASED * self._rate)
            self._last = heard.over
        drive = learned
        self.has_fallen = False
        if heard.over > BROKEN and (is_first or heard.over > self._last) and len(self._learned) > 1:
            drive = self._back(heard.over, learned)
        else:
            still = LEARNED if is_first else float(np.clip(heard.over / max(self._last, _TINY), LEARNING, 1.0))
            self._left = heard.over * still
            if (rise := self._possible_rise()) > 0:
                drive = self._predicted(learned, rise, noise)
                self._learned.append((self.level, learned))
                self._go_to(self.level + rise, True)
        self._last = heard.over
        if self.level == before:
            return drive, None
        told = {"from": tidy(before), "to": tidy(self.level), "loudest_db": _tidy_db(heard.over)}
        return drive, Decision("level", {**told, "at_hz": tidy(heard.frequency)})

    def _back(self, over: float, learned: np.ndarray) -> np.ndarray:
        """Take a rise back, half of it or, where that was not enough or will not be, all; return the drive."""
        below, drive = self._learned[-1]
        self._predictions = None  # of a level that is left
        if self._has_risen and self._held == 1 and over < FAR:
            self._go_to((below + self.level) / 2, False)
            halfway: np.ndarray = drive + 0.5 * (learned - drive)
            return halfway
        self._learned.pop()
        self._go_to(below, False)
        self.has_fallen = True
        return drive

    def _predicted(self, learned: np.ndarray, rise: float, noise: np.ndarray) -> np.ndarray:
        """Return the drive for a level higher by `rise`: as the last one would have been predicted best, by line."""
        level, drive = next(each for each in reversed(self._learned) if self.level - each[0] >= BASE * rise)
        scaled = learned + self._beyond_noise(learned, noise) * (rise / self.level)
        curved = learned + self._beyond_noise(learned - drive, noise) * (rise / (self.level - level))
        share = self._share_of_curved(learned)
        self._predictions = scaled, curved
        predicted: np.ndarray = scaled + share * (curved - scaled)
        return predicted

    def _share_of_curved(self, learned: np.ndarray) -> np.ndarray:
        """Return how far from the scaled to the curved prediction lies what was learned, (lines, inputs), 0 to 1."""
        if self._predictions is None:
            return np.zeros(learned.shape)
        scaled, curved = self._predictions
        apart = curved - scaled
        along = smoothed((apart.conj() * (learned - scaled)).real, self._reach)
        share: np.ndarray = np.clip(along / np.maximum(smoothed(np.abs(apart) ** 2, self._reach), _TINY), 0.0, 1.0)
        return share

    def _beyond_noise(self, drive: np.ndarray, noise: np.ndarray) -> np.ndarray:
        """Return lines (lines, inputs), V s, without the part of their power that noise explains."""
        size = np.maximum(smoothed(np.abs(drive) ** 2, self._reach), _TINY)
        kept: np.ndarray = np.maximum(1.0 - 2.0 * median_filter(noise, (2 * AROUND + 1, 1)) / size, 0.0) * drive
        return kept

    def _possible_rise(self) -> float:
        """Return by how much the level is to rise, 0 where it is to stay."""
        if self.level >= 1.0:
            return 0.0
        largest = min(max(LARGER * self._rise, MODEST * self.level), (LARGER - 1.0) * self.level, 1.0 - self.level)
        least = min(SMALLEST * self.level, 1.0 - self.level)
        rises = largest * np.linspace(0.0, 1.0, TRIED)
        brought = self._rate * rises * (1 + rises / self.level) ** STEEPER
        rise = float(rises[self._left + brought <= TARGET].max(initial=0.0))
        if rise > 0 and rise >= (least if self._held >= PATIENCE else ENOUGH * largest):
            return rise
        return least if self._left < TARGET and self._held >= 2 * PATIENCE else 0.0

    def _go_to(self, level: float, has_risen: bool) -> None:
        self.level = 1.0 if level > 1.0 - ROUNDING else level
        self._rise, self._held, self._has_risen = self.level - self._learned[-1][0], 0, has_risen


def _tidy_db(over: float) -> float:
    return round(20 * float(np.log10(max(over, 1e-4))), 1)
