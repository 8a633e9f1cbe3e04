"""The learning of a run, from shot to shot, in lines: what is believed of the vibrator, and the next drive."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from vibractl.config import Adaptation
from vibractl.disturbance import Disturbance, smoothed
from vibractl.law import Law, bounded_inverse
from vibractl.learning import update
from vibractl.line_filter import LineFilter
from vibractl.rollback import Rollback
from vibractl.transfer_matrix import contraction

DEVIATIONS = 2.0
"""Standard deviations that a bound allows for."""
CONFIDENCE = 0.97
"""Part of the lines whose last error should have been within its bound; bounds widen until it is."""
REACH = 10
"""Lines to each side over which powers are averaged."""


@dataclass(frozen=True)
class Shot:
    """One shot in lines.

    Parameters
    ----------
    drive : complex array, shape (lines, inputs), V s
    response : complex array, shape (lines, outputs), m/s^2 s
    noise : array, shape (lines, outputs), (m/s^2 s)^2
        E |N|^2 in the response.
    """

    drive: np.ndarray
    response: np.ndarray
    noise: np.ndarray


@dataclass(frozen=True)
class Decision:
    """Something out of the ordinary that was decided, and the values that decided it."""

    event: str
    fields: dict[str, Any]


class Algorithm:
    """Learns from shot to shot.  With every part of [adaptation] off it is the law of the thesis.

    `lines` is the next drive; `response` is what is believed of G; `gain`, `certificate` and `error_bound` (lines,)
    belong to the update last made: Q2, at most `nominal`; the bound on the norm of its error map, with G's uncertainty
    (1); and how large the next error may then be, with noise and the distortion that follows the strong lines
    (m/s^2 s).  `decisions` are those of the last step.

    Parameters
    ----------
    law : Law
    adaptation : Adaptation
    """

    def __init__(self, law: Law, adaptation: Adaptation) -> None:
        self.law = law
        self._parts = adaptation if law.settings.law == "kalman" else _NOTHING
        tonal = bool(np.any(law.active == 0.0))  # lines apart, that say nothing of their neighbours
        self._reach = 0 if tonal else REACH
        self._neighbours = 0 if tonal else adaptation.neighbours
        self._disturbance = Disturbance(law.reference, adaptation.coupling, self._reach)
        self.restart()

    def restart(self) -> None:
        """Go back to the first drive."""
        law, parts = self.law, self._parts
        self.number = 0
        self.lines = law.start.copy()
        self.decisions: list[Decision] = []
        self._filter = LineFilter(law.matrix.response, law.matrix.variance, parts.walk, parts.doubt, self._neighbours)
        self._inverse = law.inverse
        self._rollback = Rollback() if parts.rollback else None
        self._before: Shot | None = None
        self.nominal = law.gains.at(0)
        self.gain = self.nominal * law.active
        self.certificate = contraction(law.matrix.response, self._filter.variance, self._inverse, self.gain, DEVIATIONS)
        self.error_bound = self.certificate * np.linalg.norm(law.reference, axis=1)
        self._caution = 1.0

    @property
    def response(self) -> np.ndarray:
        """G, (lines, outputs, inputs), m/s^2 per V."""
        return self._filter.response

    def step(self, shot: Shot) -> None:
        """Learn from a shot that was made with `lines`."""
        self.decisions = []
        error = self.law.reference - shot.response
        if self._parts.model and self._before is not None:
            self._follow(shot, self._before)
        self._choose_gain(shot, error)
        self.lines = update(shot.drive, self._inverse, error, self.gain)
        if self._rollback is not None and (best := self._rollback.judged(self.number, shot.drive, error)):
            self.lines = best.lines
            self.decisions.append(Decision("rollback", {"to_shot": best.shot, "error_db": best.growth_db}))
        self._before = shot
        self.number += 1

    def _follow(self, shot: Shot, before: Shot) -> None:
        """Correct G by what this shot shows beside the one before."""
        step, change = shot.drive - before.drive, shot.response - before.response
        power = np.abs(self._distortion(shot)) ** 2 + np.abs(self._distortion(before)) ** 2
        share = self._disturbance.change(change, shot.response)
        self._filter.observe(step, change, self._disturbance.power(shot.noise + before.noise, power, share))
        self._inverse = bounded_inverse(self.response, self.law.settings)

    def _distortion(self, shot: Shot) -> np.ndarray:
        """Return what G does not explain of a response, (lines, outputs)."""
        unexplained: np.ndarray = shot.response - (self.response @ shot.drive[..., None])[..., 0]
        return unexplained

    def _choose_gain(self, shot: Shot, error: np.ndarray) -> None:
        """Set Q2 of the coming update, and the bounds on what it leaves of the error."""
        self.nominal = self.law.gains.at(self.number) * (self._rollback.pace if self._rollback else 1.0)
        self.gain = self.nominal * self.law.active
        share = self._disturbance.change(self.nominal * error, shot.response)
        coming = self._disturbance.power(shot.noise, np.abs(self._distortion(shot)) ** 2, share).sum(axis=1)
        power = smoothed(np.abs(error) ** 2, self._reach).sum(axis=1)
        if self._parts.cautious:
            self.gain = self.gain * power / (power + coming)
        self.certificate = contraction(self.response, self._filter.variance, self._inverse, self.gain, DEVIATIONS)
        size = np.linalg.norm(error, axis=1)
        self._caution = self._outcome(size) if self.number else 1.0
        self.error_bound = self._caution * (self.certificate * size + DEVIATIONS * np.sqrt(coming))

    def _outcome(self, size: np.ndarray) -> float:
        """Return by how much bounds are to be wider than computed, from how the last one, (lines,), has held."""
        held = size[self.law.active > 0] / np.maximum(self.error_bound[self.law.active > 0], np.finfo(float).tiny)
        needed = self._caution * float(np.quantile(held, CONFIDENCE))
        return max(1.0, needed, (needed + self._caution) / 2)


_NOTHING = Adaptation(model=False, doubt=0.0, cautious=False, rollback=False)
