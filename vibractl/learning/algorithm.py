"""The learning of a run, from shot to shot, in lines: what is believed of the vibrator, and the next drive."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from vibractl import config
from vibractl.config import Adaptation
from vibractl.learning.disturbance import Disturbance, smoothed
from vibractl.learning.law import Law, bounded_inverse, reference_level
from vibractl.learning.line_filter import LineFilter
from vibractl.learning.reidentify import LEAST, Reidentification, probe
from vibractl.learning.rollback import Rollback
from vibractl.learning.shot import Shot
from vibractl.learning.stretch import Stretch
from vibractl.learning.update import update
from vibractl.learning.variation import Variation, swings_of
from vibractl.learning.warm_start import Check, KnownDrive
from vibractl.learning.watch import Trouble, Watch
from vibractl.transfer_matrix import contraction, norm

DEVIATIONS = 2.0
"""Standard deviations that a bound allows for."""
CONFIDENCE = 0.97
"""Part of the lines whose last error should have been within its bound; bounds widen until it is."""
DOUBT = 1.0
"""Of its size: how uncertain G is where a band has diverged."""
REACH = 10
"""Lines to each side over which powers are averaged."""


@dataclass(frozen=True)
class Decision:
    """Something out of the ordinary that was decided, and the values that decided it."""

    event: str
    fields: dict[str, Any]


def tidy(value: float) -> float:
    """Round a figure for the events: to four digits after the point."""
    return round(float(value), 4)


class Algorithm:
    """Learns from shot to shot.  With every part of [adaptation] and [watch] off it is the law of the thesis.

    `lines` is the next drive, made to "learn", to "reidentify" or to "check": `purpose`; `response` is what is believed
    of G; `gain`, `certificate` and `error_bound` (lines,) belong to the update last made: Q2, at most `nominal`; the
    bound on the norm of its error map, with G's uncertainty (1); and how large the next error may then be, with noise
    and the distortion that follows the strong lines (m/s^2 s).  `decisions` are those of the last step.

    Parameters
    ----------
    law : Law
    adaptation : Adaptation
    watch : config.Watch
    objective : float, dB
        Limit on errors, re the reference's level.
    known : KnownDrive, optional
        To be checked, and if it fits, to be started from.

    Source
    ------
    Sörnmo 2015, Algorithm 1.
    """

    def __init__(
        self,
        law: Law,
        adaptation: Adaptation,
        watch: config.Watch,
        objective: float,
        known: KnownDrive | None = None,
    ) -> None:
        self.law, self._known = law, known
        self._parts = adaptation if law.settings.law == "kalman" else _NOTHING
        self._watching = watch
        self._limit = float(reference_level(law.reference).min()) * 10 ** (objective / 20)
        tonal = bool(np.any(law.active == 0.0))  # lines apart, that say nothing of their neighbours
        self._reach = 0 if tonal else REACH
        self._neighbours = 0 if tonal else adaptation.neighbours
        self._disturbance = Disturbance(law.reference, adaptation.coupling, self._reach)
        update(law.start, law.inverse, np.zeros_like(law.reference), 0.0)  # compiles, before a stream is opened
        self.restart()

    def restart(self) -> None:
        """Go back to the first drive."""
        law, parts = self.law, self._parts
        self.number = self._learned = 0
        self.lines = law.start.copy()
        self.decisions: list[Decision] = []
        model, linked = law.matrix, parts.model and self._neighbours > 0
        swings = swings_of(model.inputs) if parts.variation and linked else None
        variation = None if swings is None else Variation(model.frequency, swings)
        self._filter = LineFilter(model.response, model.variance, parts.walk, parts.doubt, self._neighbours, variation)
        self._inverse, self._weight = law.inverse, np.array(law.settings.weights or np.ones(model.outputs))
        self._rollback = Rollback() if parts.rollback else None
        self._stretch = Stretch(model.frequency, model.response) if parts.stretch and linked else None
        self._watch = Watch(law, self._watching, self._limit) if self._watching.on else None
        self._running: Reidentification | None = None
        self._checking = Check(self._known, law.reference, self._limit) if self._known else None
        if self._checking is not None:
            self.lines = self._checking.drive
        self._treated: list[float] = []
        self._open = law.active.copy()
        self._before: Shot | None = None
        self._caution = 1.0
        self.nominal = law.gains.at(0)
        self.gain = self.nominal * law.active
        self.certificate = contraction(law.matrix.response, self._filter.variance, self._inverse, self.gain, DEVIATIONS)
        self.error_bound = self.certificate * np.linalg.norm(law.reference, axis=1)

    @property
    def response(self) -> np.ndarray:
        """G, (lines, outputs, inputs), m/s^2 per V."""
        return self._filter.response

    @property
    def variance(self) -> np.ndarray:
        """E |G_hat - G|^2, (lines, outputs, inputs), (m/s^2 per V)^2."""
        return self._filter.variance

    def explained(self, drive: np.ndarray) -> np.ndarray:
        """Return G U (lines, outputs), m/s^2 s, of lines U (lines, inputs), V s."""
        return self._filter.explained(drive)

    @property
    def purpose(self) -> str:
        """What the next shot is for."""
        if self._checking is not None:
            return "check"
        return "learn" if self._running is None else "reidentify"

    @property
    def level(self) -> float:
        """The level of the next drive, 1: below 1 while a known drive is checked at reduced level."""
        return 1.0 if self._checking is None else self._checking.level

    def step(self, shot: Shot) -> None:
        """Take a shot that was made with `lines`."""
        self.decisions = []
        if self._checking is not None:
            self._checked(shot, self._checking)
        elif self._running is None:
            self._consider(shot)
        else:
            self._probed(shot, self._running)
        self.number += 1

    def _checked(self, shot: Shot, check: Check) -> None:
        """Take a shot of the check of a known drive; go on with it, learn from it, or start as without it."""
        found = check.take(shot.response)
        fields = {"entry": check.known.name, **{key: tidy(value) for key, value in vars(found).items()}}
        if not found.accepted:
            self._checking, self.lines = None, self.law.start.copy()
            self.decisions.append(Decision("library_refused", fields))
        elif check.over:
            self._checking = None
            self._learned = sum(self.law.gains.stages) if found.worst_db <= 0 else 0  # no haste where it is met
            self.decisions.append(Decision("library_accepted", fields))
            self._learn(shot, self.law.reference - shot.response)
        else:
            self.lines = check.drive

    def _consider(self, shot: Shot) -> None:
        """Learn from a shot, unless a band diverges."""
        if self._parts.model and self._before is not None:
            self._follow(shot, self._before)
        error = self.law.reference - shot.response
        if self._watch is not None and self._learned:
            trouble = self._watch.judged(shot.drive, error, self.error_bound / self._caution)  # as computed
            if trouble is not None and self._intervened(self._watch, trouble, shot, error):
                return
        self._learn(shot, error)

    def _learn(self, shot: Shot, error: np.ndarray) -> None:
        """Make the next drive from a shot."""
        learned = self._open > 0
        expected = float(np.linalg.norm(self.error_bound[learned]))
        self._choose_gain(shot, error)
        self.lines = self._next(shot, error)
        back = self._rollback and self._rollback.judged(self.number, shot.drive, error[learned], expected)
        if back:
            self.lines = back.lines
            self.decisions.append(Decision("rollback", {"to_shot": back.shot, "error_db": tidy(back.growth_db)}))
        self._before = shot
        self._learned += 1

    def _next(self, shot: Shot, error: np.ndarray) -> np.ndarray:
        """Return the drive that is believed to take `gain` of the error away, and what the modes will do until then."""
        coming = np.zeros_like(error)
        if self._stretch is not None:
            coming = (self._stretch.coming() @ shot.drive[..., None])[..., 0]
        if self._before is None or not self._filter.varies:
            drive = update(shot.drive, self._inverse, error, self.gain)
            return drive if self._stretch is None else update(drive, self._inverse, -coming, self._open)
        wanted, inverse = self.gain[:, None] * error - coming, self._inverse * self._open[:, None, None]
        change = self._filter.step_for(wanted, inverse, self._weight)
        following: np.ndarray = shot.drive + change
        return following

    def _intervened(self, watch: Watch, trouble: Trouble, shot: Shot, error: np.ndarray) -> bool:
        """Begin to reidentify a band, or freeze it when that has been done often enough; say whether it has begun."""
        watching, frequency = self._watching, self.law.matrix.frequency
        near = np.abs(frequency - trouble.centre) <= watching.half_width
        fields = {"band_hz": [tidy(frequency[near][0]), tidy(frequency[near][-1])], "at_hz": tidy(trouble.centre)}
        self.decisions.append(Decision("divergence", {**fields, "test": trouble.test, **trouble.values}))
        if sum(abs(centre - trouble.centre) <= watching.half_width for centre in self._treated) >= watching.rounds:
            self._open = np.where(near, 0.0, self._open)
            watch.dismiss(near)
            if self._rollback is not None:
                self._rollback.forget()
            self.decisions.append(Decision("frozen", {**fields, "rounds": watching.rounds}))
            return False
        size = np.abs(error).max(axis=1)
        room = np.maximum(self._limit - size, LEAST * self._limit) * self.law.active
        made = probe(
            frequency, self.response, self._filter.variance, room, trouble.centre, watching.half_width, watching.share
        )
        self._treated.append(trouble.centre)
        self._running = Reidentification(made, trouble.centre, shot, watching.input == "zeroed")
        self.lines = self._running.drive
        self.decisions.append(Decision("reidentify", {**fields, "shots": len(made.lines)}))
        return True

    def _probed(self, shot: Shot, running: Reidentification) -> None:
        """Take a shot of a reidentification; after the last one go on from where it began."""
        if not running.take(shot):
            self.lines = running.drive
            return
        before, old = self.response.copy(), self._inverse
        self._filter.forget(running.probe.inside, DOUBT)
        for step, change, noise in running.evidence():
            self._filter.observe(step, change, noise + running.repeatability)
        self._inverse = bounded_inverse(self.response, self.law.settings)
        self.decisions.append(self._gained(running, before, old))
        if self._watch is not None:
            self._watch.forgive(running.centre)
        if self._rollback is not None:
            self._rollback.forget()
        self._running = None
        self._learn(running.base, self.law.reference - running.base.response)

    def _gained(self, running: Reidentification, before: np.ndarray, old: np.ndarray) -> Decision:
        """Say how far G has moved in the band, and what its error map was with the old inverse and is with the new."""
        inside, now = running.probe.inside, self.response[running.probe.inside]
        moved = norm(now - before[inside]) / norm(before[inside])
        sure = np.zeros(now.shape)
        was, will = (contraction(now, sure, inverse[inside], self.nominal).max() for inverse in (old, self._inverse))
        fields = {"band_hz": [tidy(edge) for edge in running.probe.band], "moved": tidy(np.median(moved))}
        return Decision("reidentified", {**fields, "contraction_before": tidy(was), "contraction_after": tidy(will)})

    def _follow(self, shot: Shot, before: Shot) -> None:
        """Correct G by what this shot shows beside the one before."""
        step, change = shot.drive - before.drive, shot.response - before.response
        power = np.abs(self._distortion(shot)) ** 2 + np.abs(self._distortion(before)) ** 2
        share = self._disturbance.change(change, shot.response)
        moved = (self._parts.drift * np.abs(self.explained(shot.drive))) ** 2
        spilt = (self._parts.spill * np.abs(self.explained(step))) ** 2
        spilt = spilt + self._parts.scatter**2 * self._filter.around(step)
        noise = self._disturbance.power(shot.noise + before.noise, power, share)
        noise = noise + smoothed(moved + spilt, self._reach)
        if self._stretch is not None:
            surprise = change - self.explained(step)
            shift = self._stretch.observe(before.drive, surprise, noise + self._filter.spread(step))
            self._filter.shift(shift)
            change = change - (shift @ before.drive[..., None])[..., 0]
        self._filter.observe(step, change, noise)
        self._inverse = bounded_inverse(self.response, self.law.settings)

    def _distortion(self, shot: Shot) -> np.ndarray:
        """Return what G does not explain of a response, (lines, outputs)."""
        unexplained: np.ndarray = shot.response - self.explained(shot.drive)
        return unexplained

    def _choose_gain(self, shot: Shot, error: np.ndarray) -> None:
        """Set Q2 of the coming update, and the bounds on what it leaves of the error."""
        self.nominal = self.law.gains.at(self._learned) * (self._rollback.pace if self._rollback else 1.0)
        self.gain = self.nominal * self._open
        share = self._disturbance.change(self.nominal * error, shot.response)
        coming = self._disturbance.power(shot.noise, np.abs(self._distortion(shot)) ** 2, share).sum(axis=1)
        power = smoothed(np.abs(error) ** 2, self._reach).sum(axis=1)
        if self._parts.cautious:
            self.gain = self.gain * power / (power + coming)
        self.certificate = contraction(self.response, self._filter.variance, self._inverse, self.gain, DEVIATIONS)
        size = np.linalg.norm(error, axis=1)
        self._caution = self._outcome(size) if self._learned else 1.0
        self.error_bound = self._caution * (self.certificate * size + DEVIATIONS * np.sqrt(coming))

    def _outcome(self, size: np.ndarray) -> float:
        """Return by how much bounds are to be wider than computed, from how the last one, (lines,), has held."""
        held = size[self.law.active > 0] / np.maximum(self.error_bound[self.law.active > 0], np.finfo(float).tiny)
        needed = self._caution * float(np.quantile(held, CONFIDENCE))
        return max(1.0, needed, (needed + self._caution) / 2)


_NOTHING = Adaptation(model=False, doubt=0.0, cautious=False, rollback=False)
