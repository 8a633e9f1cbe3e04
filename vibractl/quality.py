"""How good a shot was: the objective, tracking, overtones, head-room and repeatability, each with its definition."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vibractl.config import Limits, Quality
from vibractl.decibels import FAINT, decibels, rms
from vibractl.judging import Judged
from vibractl.learning.disturbance import noise_power, noise_reach
from vibractl.learning.law import reference_level
from vibractl.learning.law_of_run import settled_window
from vibractl.learning.laws import strong_lines
from vibractl.mains import Hum, Mains
from vibractl.overtones import Overtones
from vibractl.place import Place
from vibractl.spectrum import DECIMATOR_CORNER, Decimator, LineSpectrum

BAND_WIDTH = 50.0
"""Hz, of the bands whose level is reported beside the worst line."""
PASS, FAIL, HIDDEN = "pass", "fail", "hidden"
"""Verdicts on a shot; hidden: over the limit by no more than the ambience may explain."""


def holds_from(met: Sequence[bool]) -> int | None:
    """Return the shot, counted from 0, from which the objective holds to the end; None if it does not at the end.

    Examples
    --------
    >>> holds_from([False, True, False, True, True])
    3
    """
    first = len(met)
    while first and met[first - 1]:
        first -= 1
    return first if first < len(met) else None


@dataclass(frozen=True)
class Marks:
    """The figures of one shot, arrays over the accelerometers controlled unless said otherwise.

    `iae` sum |e| at the learner's rate (6.26), m/s^2; `error_db` rms error re rms reference; `worst_line_db` and
    `worst_line_hz` the line nearest to, or farthest above, the limit (dB over it: negative is good); `heard_line_db`
    the same with the mains' hum in it; `hidden` how many lines are over the limit by no more than the ambience may
    explain, `proven` how many by more; `worst_band_db` and `worst_band_hz` as for lines, for bands of 50 Hz;
    `overtone_db` (4, accelerometers) re the root, followed along the reference's phase; `thd_db` all energy from
    `quality.above` to `quality.judged_to` re the reference's; `phase_mean` and `phase_peak` rad, of the response
    against the reference; `headroom_db` (coils,) peak limit over peak drive; `outputs` the accelerometers controlled,
    or hydrophones, counted from 0; `sensor` is what one of them is called;
    `level` (1) at which the reference was to be emitted.  In the far field m/s^2 are Pa.
    """

    iae: np.ndarray
    error_db: np.ndarray
    worst_line_db: np.ndarray
    worst_line_hz: np.ndarray
    heard_line_db: np.ndarray
    hidden: np.ndarray
    proven: np.ndarray
    worst_band_db: np.ndarray
    worst_band_hz: np.ndarray
    overtone_db: np.ndarray
    thd_db: np.ndarray
    phase_mean: np.ndarray
    phase_peak: np.ndarray
    headroom_db: np.ndarray
    outputs: tuple[int, ...]
    sensor: str
    level: float = 1.0

    @property
    def verdict(self) -> str:
        """Whether the objective holds on every line and side: pass, fail, or hidden by the ambience."""
        if self.proven.any():
            return FAIL
        return PASS if np.all(self.worst_line_db <= 0) else HIDDEN

    @property
    def met(self) -> bool:
        """Whether the objective has been seen to hold on every line and side."""
        return self.verdict == PASS and self.level == 1.0

    @property
    def reason(self) -> str:
        """Say why the objective is met or not, in one line."""
        side = int(np.argmax(self.worst_line_db))
        over, place = self.worst_line_db[side], self.worst_line_hz[side]
        where = f"{abs(over):.1f} dB at {place:.1f} Hz, {self.sensor} {self.outputs[side] + 1}"
        if self.verdict == HIDDEN:
            where = f"{where}, which the ambience may explain"
        if self.level != 1.0:
            how = f"at {decibels(self.level):.3g} dB of the reference"
            return f"not judged: {how}, loudest bin {'over' if over > 0 else 'within'} the limit by {where}"
        if self.verdict == HIDDEN:
            return f"not judged: over the limit by {where}"
        return f"met by {where}" if self.met else f"missed by {where}"


class Judge:
    """Judges the shots of one run.

    Parameters
    ----------
    setup : Judged
        A run's set-up, or what is judged without one.
    place : Place, optional
        One of the set-up's; the accelerometers without it.
    """

    def __init__(self, setup: Judged, place: Place | None = None) -> None:
        self.place = place or setup.places[0]
        self._quality: Quality = setup.config.quality
        self._limits: Limits = setup.config.limits
        self._shot, self._outputs = setup.shot, list(self.place.sensors)
        step = setup.config.learning.decimation
        self._decimator = Decimator(step)
        self._rate = rate = setup.shot.rate / step
        frames, width = setup.shot.frames // step, len(self._outputs)
        low = min(setup.config.learning.band[0], self._quality.above)
        high = min(self._quality.judged_to, DECIMATOR_CORNER * rate / 2)
        self._spectrum = LineSpectrum(frames, width, rate, (low, high), setup.plans)
        self.frequency = self._spectrum.frequency
        self._reference = self.place.reference
        self._settled = settled_window(setup.reference, frames)
        self._seconds = np.count_nonzero(self._settled * np.ones((frames, 1))) / rate
        self._wanted = self.lines(self._reference)
        self._root = setup.reference.root
        self._judged = self._judged_lines(setup.config.learning.overtones)
        self._overtones = Overtones(self._reference, rate, self.frequency[np.argmax(strong_lines(self._wanted))])

    @property
    def reference_level(self) -> np.ndarray:
        """The reference's spectrum in its own band, (outputs,), m/s^2 s: rms of its significant lines."""
        return reference_level(self._wanted)

    @property
    def limit(self) -> np.ndarray:
        """The largest error allowed at a judged line, (outputs,), m/s^2 s."""
        return self.reference_level * 10 ** (self._quality.objective / 20)

    @property
    def judged(self) -> np.ndarray:
        """Which of the lines `frequency` are judged, (lines,) of bool: a sine's overtones, else all above 100 Hz."""
        return self._judged

    def error(self, response: np.ndarray, hum: Hum | None = None) -> np.ndarray:
        """Return reference minus response, (frames, outputs) at the learner's rate, m/s^2, without the hum."""
        measured = self._measured(response)
        return self._error(measured if hum is None else measured - hum.signal(len(measured), self._rate))

    def hum(self, response: np.ndarray, mains: Mains) -> Hum:
        """Return the hum in the response of a whole shot, (samples, responses), m/s^2, with which `mains` goes on."""
        return mains.observe(self._measured(response))

    def lines(self, signal: np.ndarray) -> np.ndarray:
        """Return the lines `frequency` of a signal as `error` gives it, (lines, outputs), m/s^2 s; a sine's settled."""
        return self._spectrum.lines(self._settled * signal)

    def marks(self, response: np.ndarray, drive: np.ndarray, hum: Hum | None = None, level: float = 1.0) -> Marks:
        """Judge one shot by what was emitted: the response less the ambience that its silences show.

        Parameters
        ----------
        response : array, shape (samples, responses), m/s^2, of the whole shot
        drive : array, shape (samples, drives), V
        hum : Hum, optional
            In the place's sensors, to be taken out.
        level : float, 1
            At which the reference was to be emitted; the limit is that of the full level.
        """
        measured, heard = self._measured(response), None
        if hum is not None:
            heard = self.lines(self._error(measured, level))
            measured = measured - hum.signal(len(measured), self._rate)
        return self.marks_of(self._error(measured, level), drive, self._ambience(measured, hum), heard, level)

    def marks_of(
        self,
        error: np.ndarray,
        drive: np.ndarray,
        ambience: np.ndarray | float = 0.0,
        heard: np.ndarray | None = None,
        level: float = 1.0,
    ) -> Marks:
        """Judge one shot by its error.

        Parameters
        ----------
        error : array, shape (frames, outputs), m/s^2
            As of `error`.
        drive : array, shape (samples, drives), V
        ambience : array, shape (lines, outputs), (m/s^2 s)^2
            E |line|^2 of what would be there without a drive.
        heard : array, shape (lines, outputs), m/s^2 s
            Lines of the error with the hum in them, where it was taken out.
        level : float, 1
            As of `marks`.
        """
        lines = self.lines(error)
        over = decibels(lines / self.limit)[self._judged]
        worst = over.argmax(axis=0)
        reach = np.sqrt(noise_reach(ambience, over.size))
        proven = (np.abs(lines) - reach > self.limit)[self._judged]
        band_db, band_hz = self._bands(lines)
        first, phase = self._overtones.follow(level * self._reference - error)
        peak = np.maximum(np.abs(drive).max(axis=0), FAINT)
        return Marks(
            iae=np.abs(error).sum(axis=0),
            error_db=decibels(rms(error) / rms(self._reference)),
            worst_line_db=over.max(axis=0),
            worst_line_hz=self.frequency[self._judged][worst],
            heard_line_db=decibels((lines if heard is None else heard) / self.limit)[self._judged].max(axis=0),
            hidden=((over > 0) & ~proven).sum(axis=0),
            proven=proven.sum(axis=0),
            worst_band_db=band_db,
            worst_band_hz=band_hz,
            overtone_db=first,
            thd_db=self._distortion(lines),
            phase_mean=phase.mean(axis=0),
            phase_peak=np.abs(phase).max(axis=0),
            headroom_db=decibels(self._limits.peak / peak),
            outputs=tuple(self._outputs),
            sensor=self.place.sensor,
            level=level,
        )

    def _measured(self, response: np.ndarray) -> np.ndarray:
        """Return what the place's sensors have heard, (samples, outputs), at the learner's rate."""
        measured: np.ndarray = self._decimator.apply(np.asarray(response[:, self._outputs], dtype=float))
        return measured

    def _error(self, measured: np.ndarray, level: float = 1.0) -> np.ndarray:
        error: np.ndarray = level * self._reference - self.place.frame(
            measured, self._shot.lead // self._decimator.factor
        )
        return error

    def _ambience(self, measured: np.ndarray, hum: Hum | None) -> np.ndarray:
        """Return E |line|^2, (lines, outputs), (m/s^2 s)^2, of noise as in the quieter silence, and the hum's rest."""
        step, frames = self._decimator.factor, len(self._reference)
        lead, tail = measured[: self._shot.lead // step], measured[-(self._shot.after // step) // 2 :]
        power = [noise_power(part, self._rate, self.frequency, frames) for part in (lead, tail)]
        noise: np.ndarray = np.minimum(*power) * np.mean(np.square(self._settled))
        return noise if hum is None else noise + hum.doubted(self.frequency, self._seconds, self._root is not None)

    def _judged_lines(self, overtones: int) -> np.ndarray:
        if self._root is None:
            return self.frequency >= self._quality.above
        order = np.round(self.frequency / self._root)
        exact = np.abs(self.frequency - order * self._root) < 1e-6
        return exact & (order >= 2) & (order <= overtones + 1)

    def _bands(self, lines: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        number = ((self.frequency - self._quality.above) // BAND_WIDTH).astype(int)
        inside = np.unique(number[(self.frequency >= self._quality.above)])
        level = np.stack([rms(np.abs(lines[number == band])) / self.limit for band in inside])
        worst = level.argmax(axis=0)
        return decibels(level.max(axis=0)), self._quality.above + (inside[worst] + 0.5) * BAND_WIDTH

    def _distortion(self, lines: np.ndarray) -> np.ndarray:
        high = self.frequency >= self._quality.above
        energy = (np.abs(lines[high]) ** 2).sum(axis=0) / (np.abs(self._wanted) ** 2).sum(axis=0)
        return decibels(np.sqrt(energy))
