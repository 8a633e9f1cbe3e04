"""The check of a warm start: a drive learned before is tried at reduced level before it is trusted."""

from dataclasses import dataclass

import numpy as np

from vibractl.learning.laws import strong_lines

ORDER = 2
"""By which power of the level that part of a drive rises which makes up for distortion, and an error as well."""
FURTHEST = 0.5
"""Of the response expected, rms over the reference's strong lines: further off it is another machine."""


@dataclass(frozen=True)
class KnownDrive:
    """A drive learned in an earlier run, and what it made.

    Parameters
    ----------
    name : str
    drive : complex array, shape (lines, inputs), V s
    response : complex array, shape (lines, outputs), m/s^2 s
    model : complex array, shape (lines, outputs, inputs), m/s^2 per V
        G as believed at the end of that run.
    judged : array, shape (lines,) of bool
        Lines for which the objective holds.
    levels : tuple of floats, dB
        At which it is to be checked, rising to 0.
    """

    name: str
    drive: np.ndarray
    response: np.ndarray
    model: np.ndarray
    judged: np.ndarray
    levels: tuple[float, ...]


@dataclass(frozen=True)
class Finding:
    """What one level has shown.

    Parameters
    ----------
    level_db : float, dB
    off : float, 1
        RMS difference of the response from what was expected, re that, over the reference's strong lines.
    error : float, 1
        RMS error over the judged lines as it may become at the next level, re what is allowed there.
    worst_db : float, dB
        Largest error over the judged lines, over the objective's limit.
    """

    level_db: float
    off: float
    error: float
    worst_db: float

    @property
    def accepted(self) -> bool:
        """Whether the next level may be tried."""
        return self.off <= FURTHEST and self.error <= 1.0


class Check:
    """The shots of one check.

    At level s the strong lines of the reference are scaled by s and all others, which make up for distortion, by s^2:
    scaled by s alone they would themselves be heard, since distortion falls faster than the level.

    The error over the judged lines is expected to grow by (s'/s)^2 up to the next level s', and must then stay below
    s' times what a drive that makes up for nothing would leave at full level: D of the earlier run, or as much as the
    objective allows where that is more.

    Parameters
    ----------
    known : KnownDrive
    reference : complex array, shape (lines, outputs), m/s^2 s
    limit : float, m/s^2 s
        The largest error that the objective allows at a line.
    """

    def __init__(self, known: KnownDrive, reference: np.ndarray, limit: float) -> None:
        self.known, self._reference, self._limit = known, reference, limit
        self._levels = [10 ** (level / 20) for level in known.levels]
        self._done = 0
        self._strong = strong_lines(reference)
        distortion = (known.response - (known.model @ known.drive[..., None])[..., 0])[known.judged]
        allowed = limit * float(np.sqrt(distortion.size))
        self._left = max(float(np.linalg.norm(distortion)), allowed, np.finfo(float).tiny)

    @property
    def level(self) -> float:
        """Of the next shot, 1."""
        return self._levels[self._done]

    @property
    def drive(self) -> np.ndarray:
        """The next drive, (lines, inputs), V s; the known one, bit for bit, at full level."""
        return self._scaled(self.known.drive)

    @property
    def over(self) -> bool:
        """Whether all levels have been heard."""
        return self._done == len(self._levels)

    def take(self, response: np.ndarray) -> Finding:
        """Judge the response (lines, outputs), m/s^2 s, to `drive`, and go on to the next level."""
        level, known, strong = self.level, self.known, self._strong
        expected, error = level * known.response[strong], (self._scaled(self._reference) - response)[known.judged]
        self._done += 1
        following = level if self.over else self.level
        off = np.linalg.norm(response[strong] - expected) / max(np.linalg.norm(expected), np.finfo(float).tiny)
        grown = float(np.linalg.norm(error)) * (following / level) ** ORDER
        worst = 20 * np.log10(max(float(np.abs(error).max(initial=0.0)) / self._limit, 1e-12))
        return Finding(known.levels[self._done - 1], float(off), grown / (following * self._left), worst)

    def _scaled(self, lines: np.ndarray) -> np.ndarray:
        """Bring lines (lines, channels) to the present level."""
        scaled: np.ndarray = np.where(self._strong[:, None], self.level, self.level**ORDER) * lines
        return scaled
