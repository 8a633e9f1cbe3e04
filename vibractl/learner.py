"""The learner: streams a trial, and between two trials turns the error into the next drive."""

from dataclasses import dataclass

import numpy as np

from rigkit.fade import rise
from vibractl.config import Limits, RigConfig
from vibractl.decibels import FAINT
from vibractl.fft_plans import Plans
from vibractl.guard import Violation, violation
from vibractl.learning.algorithm import Algorithm
from vibractl.learning.decision import Decision
from vibractl.learning.disturbance import noise_power
from vibractl.learning.shot import Shot
from vibractl.mains import Hum, Mains, Pieces
from vibractl.place import Place
from vibractl.reference import Reference
from vibractl.spectrum import Decimator, LineSpectrum
from vibractl.trial import Trial

SAME, ROUNDS = 1e-4, 50
"""Of a drive's rms: what lines found for it may leave of it, and after how many rounds no more is looked for."""
HALVINGS = 6
"""Of a step that breaks a limit, until what fits of it is known."""
ALIKE = 1e-3
"""Of a drive's rms, by which one rebuilt may differ from the recorded one and still be taken for it."""


@dataclass(frozen=True)
class Timeline:
    """A shot in samples: silence, the frame that is learned from and judged, silence.

    Parameters
    ----------
    lead, frames, tail : int, samples
    rate : float, samples/s
    rest : int, samples
        At the end of the frame, in which the reference is over and the vibrator comes to rest.
    """

    lead: int
    frames: int
    tail: int
    rate: float
    rest: int = 0

    @property
    def total(self) -> int:
        """Samples of the whole shot."""
        return self.lead + self.frames + self.tail

    @property
    def window(self) -> slice:
        """The frame."""
        return slice(self.lead, self.lead + self.frames)

    @property
    def sounded(self) -> int:
        """Samples that the reference lasts."""
        return self.frames - self.rest

    @property
    def after(self) -> int:
        """Samples of the shot after the reference."""
        return self.rest + self.tail


def timeline(config: RigConfig, reference: Reference) -> Timeline:
    """Return the shot of a reference, which is the frame; its silences are multiples of the decimation."""
    lead, after = silences(config)
    return Timeline(lead, len(reference.signal), after - reference.rest, config.audio.rate, reference.rest)


def silences(config: RigConfig) -> tuple[int, int]:
    """Return how long it is silent before a reference, and after it, samples: multiples of the decimation."""
    step, rate = config.learning.decimation, config.audio.rate
    lead, after = (-(-round(seconds * rate) // step) * step for seconds in (config.shot.lead, config.shot.tail))
    return lead, after


class Learner(Trial):
    """Frequency-domain ILC as a Block: `process` streams the trial, `advance` moves to the next one.

    The drive consists of the learned lines alone, with short raised-cosine edges, and rests before the frame ends, so
    that the vibrator has rung out by then.  It is kept in float32's values so that what is recorded is what was meant.

    Parameters
    ----------
    algorithm : Algorithm
    shot : Timeline
    decimation : int, 1 or 4, of the response before it is transformed
    responses : int, accelerometers recorded
    place : Place
        Of the sensors that are learned from.
    plans : Plans
    mains : Mains, optional
        Follows the mains' hum in what the place's sensors hear, at the learner's rate: it is taken out.
    limits : Limits, optional
        Of the guard.  A step that would break one is taken as far as it fits.
    """

    def __init__(
        self,
        algorithm: Algorithm,
        shot: Timeline,
        decimation: int,
        responses: int,
        place: Place,
        plans: Plans,
        mains: Mains | None = None,
        limits: Limits | None = None,
    ) -> None:
        law = algorithm.law
        super().__init__(np.zeros((shot.total, len(law.spread))), responses)
        self.algorithm, self.shot, self._place, self.mains = algorithm, shot, place, mains
        self._limits, self.held = limits, ""
        self.far_field = np.zeros((shot.total, len(place.sensors) if place.is_far else 0))
        lines = law.matrix.frequency
        band = (lines[0], lines[-1])
        self._decimator = Decimator(decimation)
        learned, rate = shot.frames // decimation, shot.rate / decimation
        self._analysis = LineSpectrum(learned, len(place.sensors), rate, band, plans)
        self._synthesis = LineSpectrum(shot.frames, law.spread.shape[1], shot.rate, band, plans)
        self._signal = np.zeros((shot.frames, law.spread.shape[1]))
        self._edge = _edges(shot.frames, round(law.edge * shot.rate), round(law.rest * shot.rate))[:, None]
        self.restart()

    def restart(self) -> None:
        """Go back to the first drive."""
        self.algorithm.restart()
        self.hum: Hum | None = None
        if self.mains is not None:
            self.mains.restart()
        self.heard = np.zeros_like(self.algorithm.law.reference)
        self._play()

    @property
    def number(self) -> int:
        """Shots learned from."""
        return self.algorithm.number

    @property
    def lines(self) -> np.ndarray:
        """The present drive, shape (lines, inputs), V s."""
        return self.algorithm.lines

    def advance(self) -> None:
        """Learn from what was just recorded, whose lines are then in `heard`; called between ticks.

        In the far field, that is what was put into `far_field` (samples, hydrophones), Pa.
        """
        self.follow(self.analysed())

    def analysed(self) -> Shot:
        """Return what was just recorded in lines, with the drive that it was made with."""
        law, analysis, place = self.algorithm.law, self._analysis, self._place
        recorded = self.far_field if place.is_far else self.response[: self.shot.total]
        measured = self._decimator.apply(recorded[:, list(place.sensors)])
        first = self.shot.lead // self._decimator.factor
        seen, doubted = self._take_out_hum(measured)
        heard = analysis.lines(law.window * place.frame(measured, first))
        noise = noise_power(measured[:first], analysis.rate, analysis.frequency, analysis.frames)
        return Shot(self.lines, heard, noise + doubted, seen)

    def _take_out_hum(self, measured: np.ndarray) -> tuple[Pieces, np.ndarray | float]:
        """Take the hum out of a response in place; return what showed it, and what may be left in the lines."""
        if self.mains is None:
            return (), 0.0
        analysis, seen = self._analysis, self.mains.measure(measured)
        self.hum = self.mains.follow(seen)
        measured -= self.hum.signal(len(measured), analysis.rate)
        return seen, self.hum.doubted(analysis.frequency, analysis.frames / analysis.rate)

    def played(self, drive: np.ndarray) -> None:
        """Take it that this drive (samples, coils), V, was played, which other software may have made."""
        off = float(np.linalg.norm(drive - self.drive))
        if not off <= ALIKE * float(np.linalg.norm(drive)):
            self.algorithm.lines = self.lines_of(drive[self.shot.window])

    def follow(self, shot: Shot) -> None:
        """Learn from a shot in lines, as from what was just recorded."""
        self.heard, before, self.held = shot.response, self.lines, ""
        self.algorithm.step(shot)
        if self._limits is not None and self.algorithm.purpose == "learn":
            self._hold_back(before, self._limits)
        self._play()

    def _hold_back(self, before: np.ndarray, limits: Limits) -> None:
        """Take of the step from `before`, lines (lines, inputs), V s, only what the limits allow: a convex set."""
        after = self.lines
        broken = self._broken(after, limits)
        if broken is None or self._broken(before, limits) is not None:
            return
        fits, breaks = 0.0, 1.0
        for _ in range(HALVINGS):
            share = (fits + breaks) / 2
            is_fit = self._broken(before + share * (after - before), limits) is None
            fits, breaks = (share, breaks) if is_fit else (fits, share)
        self.algorithm.lines = before + fits * (after - before)
        self.held = f"limits.{broken.limit} holds drive {broken.channel + 1} back"
        fields = {"limit": broken.limit, "drive": broken.channel + 1, "share": fits}
        self.algorithm.decisions.append(Decision("drive_held_back", fields))

    def _broken(self, lines: np.ndarray, limits: Limits) -> Violation | None:
        """Return the limit that lines (lines, inputs), V s, break, shot upon shot, for a mean outlasts the silence."""
        drive = np.zeros_like(self.drive)
        drive[self.shot.window] = self.rendered(lines)
        return violation(np.concatenate((drive, drive)), limits, self.shot.rate)

    def rendered(self, lines: np.ndarray) -> np.ndarray:
        """Return the drive that has these lines (lines, inputs), V s, while the reference lasts: (frames, coils), V."""
        self._synthesis.time(lines, self._signal)
        self._signal *= self._edge
        drive: np.ndarray = (self._signal @ self.algorithm.law.spread.T).astype(np.float32)
        return drive

    def lines_of(self, drive: np.ndarray) -> np.ndarray:
        """Return the lines (lines, inputs), V s, of which a drive is made, (frames, coils), V: of `rendered`.

        Its edges have hidden some of them: conjugate gradients find such as make the same drive.
        """
        left = drive @ np.linalg.pinv(self.algorithm.law.spread).T
        lines, enough = np.zeros(self.lines.shape, complex), SAME * float(np.linalg.norm(left))
        slope = direction = self._synthesis.lines(self._edge * left)
        steepness = np.vdot(slope, slope).real
        for _ in range(ROUNDS):
            if float(np.linalg.norm(left)) <= enough:
                break
            self._synthesis.time(direction, self._signal)
            made = self._edge * self._signal
            pace = float(np.sum(made * left)) / max(float(np.sum(made**2)), FAINT)
            lines, left = lines + pace * direction, left - pace * made
            slope = self._synthesis.lines(self._edge * left)
            before, steepness = steepness, np.vdot(slope, slope).real
            direction = slope + steepness / max(before, FAINT**2) * direction
        return lines

    def _play(self) -> None:
        """Put the drive of the present lines into the trial."""
        drive = self.rendered(self.lines)
        self.drive.fill(0.0)
        self.drive[self.shot.window] = drive
        self.rewind()


def _edges(frames: int, edge: int, rest: int) -> np.ndarray:
    """Return a window (frames,) of ones with raised-cosine edges of `edge` samples, and `rest` of zeros at its end."""
    sounded = frames - rest
    window = np.zeros(frames)
    window[:sounded] = 1.0
    window[:edge] = rise(edge)
    window[sounded - edge : sounded] = rise(edge)[::-1]
    return window
