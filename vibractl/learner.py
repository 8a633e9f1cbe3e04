"""The learner: streams a trial, and between two trials turns the error into the next drive."""

from dataclasses import dataclass

import numpy as np

from vibractl.config import RigConfig
from vibractl.fft_plans import Plans
from vibractl.learning.algorithm import Algorithm
from vibractl.learning.disturbance import noise_power
from vibractl.learning.shot import Shot
from vibractl.mains import Hum, Mains, Pieces
from vibractl.place import Place
from vibractl.spectrum import Decimator, LineSpectrum
from vibractl.trial import Trial

ALIKE = 1e-3
"""Of a drive's rms, by which one rebuilt may differ from the recorded one and still be taken for it."""


@dataclass(frozen=True)
class Timeline:
    """A shot in samples: silence, the reference, silence.

    Parameters
    ----------
    lead, frames, tail : int, samples
    rate : float, samples/s
    """

    lead: int
    frames: int
    tail: int
    rate: float

    @property
    def total(self) -> int:
        """Samples of the whole shot."""
        return self.lead + self.frames + self.tail

    @property
    def window(self) -> slice:
        """Where the reference lies."""
        return slice(self.lead, self.lead + self.frames)


def timeline(config: RigConfig, frames: int) -> Timeline:
    """Return the shot for a reference of `frames` samples; its silences are multiples of the decimation."""
    step, rate = config.learning.decimation, config.audio.rate
    lead, tail = (-(-round(seconds * rate) // step) * step for seconds in (config.shot.lead, config.shot.tail))
    return Timeline(lead, frames, tail, rate)


class Learner(Trial):
    """Frequency-domain ILC as a Block: `process` streams the trial, `advance` moves to the next one.

    The drive consists of the learned lines alone, with short raised-cosine edges, and is kept in float32's values so
    that what is recorded is what was meant.

    Parameters
    ----------
    algorithm : Algorithm
    shot : Timeline
    decimation : int, 1 or 4, of the response before it is transformed
    edge : float, s, of the drive at both ends
    responses : int, accelerometers recorded
    place : Place
        Of the sensors that are learned from.
    plans : Plans
    mains : Mains, optional
        Follows the mains' hum in what the place's sensors hear, at the learner's rate: it is taken out.
    """

    def __init__(
        self,
        algorithm: Algorithm,
        shot: Timeline,
        decimation: int,
        edge: float,
        responses: int,
        place: Place,
        plans: Plans,
        mains: Mains | None = None,
    ) -> None:
        law = algorithm.law
        super().__init__(np.zeros((shot.total, len(law.spread))), responses)
        self.algorithm, self.shot, self._place, self.mains = algorithm, shot, place, mains
        self.far_field = np.zeros((shot.total, len(place.sensors) if place.is_far else 0))
        lines = law.matrix.frequency
        band = (lines[0], lines[-1])
        self._decimator = Decimator(decimation)
        learned, rate = shot.frames // decimation, shot.rate / decimation
        self._analysis = LineSpectrum(learned, len(place.sensors), rate, band, plans)
        self._synthesis = LineSpectrum(shot.frames, law.spread.shape[1], shot.rate, band, plans)
        self._signal = np.zeros((shot.frames, law.spread.shape[1]))
        self._edge = _edges(shot.frames, round(edge * shot.rate))[:, None]
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
        self.heard = shot.response
        self.algorithm.step(shot)
        self._play()

    def rendered(self, lines: np.ndarray) -> np.ndarray:
        """Return the drive that has these lines (lines, inputs), V s, while the reference lasts: (frames, coils), V."""
        self._synthesis.time(lines, self._signal)
        self._signal *= self._edge
        drive: np.ndarray = (self._signal @ self.algorithm.law.spread.T).astype(np.float32)
        return drive

    def lines_of(self, drive: np.ndarray) -> np.ndarray:
        """Return the lines (lines, inputs), V s, of a drive while the reference lasts, (frames, coils), V."""
        return self._synthesis.lines(drive / self._edge @ np.linalg.pinv(self.algorithm.law.spread).T)

    def _play(self) -> None:
        """Put the drive of the present lines into the trial."""
        drive = self.rendered(self.lines)
        self.drive.fill(0.0)
        self.drive[self.shot.window] = drive
        self.rewind()


def _edges(frames: int, edge: int) -> np.ndarray:
    """Return a window (frames,) of ones with raised-cosine edges of `edge` samples."""
    window = np.ones(frames)
    rise = 0.5 - 0.5 * np.cos(np.pi * (np.arange(edge) + 0.5) / edge)
    window[:edge] = rise
    window[len(window) - edge :] = rise[::-1]
    return window
