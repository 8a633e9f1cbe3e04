"""How good a shot was: the objective, tracking, overtones, head-room and repeatability, each with its definition."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import hilbert
from scipy.signal.windows import blackmanharris

from vibractl.config import Limits, Quality
from vibractl.judging import Judged
from vibractl.learning.law import SIGNIFICANT, reference_level, settled_window
from vibractl.place import Place
from vibractl.spectrum import Decimator, LineSpectrum

BAND_WIDTH = 50.0
"""Hz, of the bands whose level is reported beside the worst line."""
OVERTONES = 4
PERIODS = 5.0
"""Of the reference's lowest frequency, over which an overtone's amplitude and the root's phase are averaged.

From 4 on, the other orders lie outside the main lobe of a Blackman-Harris window: 92 dB down.
"""
FOLLOWED = 0.005
"""s between the values of amplitude and phase."""
FAINT = 1e-12
"""Smallest amplitude that is given in dB, to keep silence finite."""


def decibels(ratio: np.ndarray | float) -> np.ndarray:
    """Return 20 log10 |ratio|, (6.1), dB, of the same shape as `ratio`: a number or an array of any shape."""
    level: np.ndarray = 20 * np.log10(np.maximum(np.abs(ratio), FAINT))
    return level


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
    `worst_line_hz` the line nearest to, or farthest above, the limit (dB over it: negative is good), `worst_band_db`
    and `worst_band_hz` the same for bands of 50 Hz; `overtone_db` (4, accelerometers) re the root, followed along the
    reference's phase; `thd_db` all energy from `quality.above` to `quality.judged_to` re the reference's; `phase_mean`
    and `phase_peak` rad, of the response against the reference; `headroom_db` (coils,) peak limit over peak drive;
    `outputs` the accelerometers controlled, or hydrophones, counted from 0; `sensor` is what one of them is called.
    In the far field m/s^2 are Pa.
    """

    iae: np.ndarray
    error_db: np.ndarray
    worst_line_db: np.ndarray
    worst_line_hz: np.ndarray
    worst_band_db: np.ndarray
    worst_band_hz: np.ndarray
    overtone_db: np.ndarray
    thd_db: np.ndarray
    phase_mean: np.ndarray
    phase_peak: np.ndarray
    headroom_db: np.ndarray
    outputs: tuple[int, ...]
    sensor: str

    @property
    def met(self) -> bool:
        """Whether the objective holds on every line and side."""
        return bool(np.all(self.worst_line_db <= 0))

    @property
    def reason(self) -> str:
        """Say why the objective is met or not, in one line."""
        side = int(np.argmax(self.worst_line_db))
        level, place = self.worst_line_db[side], self.worst_line_hz[side]
        where = f"{abs(level):.1f} dB at {place:.1f} Hz, {self.sensor} {self.outputs[side] + 1}"
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
        rate, frames, width = setup.shot.rate / step, setup.shot.frames // step, len(self._outputs)
        low = min(setup.config.learning.band[0], self._quality.above)
        self._spectrum = LineSpectrum(frames, width, rate, (low, self._quality.judged_to), setup.plans)
        self.frequency = self._spectrum.frequency
        self._reference = self.place.reference
        self._settled = settled_window(setup.reference, frames)
        self._wanted = self.lines(self._reference)
        self._root = setup.reference.root
        self._judged = self._judged_lines(setup.config.learning.overtones)
        analytic: np.ndarray = hilbert(self._reference, axis=0)
        self._turn, self._hop = np.exp(-1j * np.angle(analytic)), max(1, round(FOLLOWED * rate))
        self._window = self._averaging(rate)
        loud = np.abs(analytic) > SIGNIFICANT * np.abs(self._reference).max(axis=0)
        self._loud = loud.all(axis=1)[:: self._hop]
        self._root_wanted = self._averaged(self._reference * self._turn)

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

    def error(self, response: np.ndarray) -> np.ndarray:
        """Return reference minus response, (frames, outputs) at the learner's rate, m/s^2."""
        measured = self._decimator.apply(np.asarray(response[:, self._outputs], dtype=float))
        first = self._shot.lead // self._decimator.factor
        error: np.ndarray = self._reference - self.place.frame(measured, first)
        return error

    def lines(self, signal: np.ndarray) -> np.ndarray:
        """Return the lines `frequency` of a signal as `error` gives it, (lines, outputs), m/s^2 s; a sine's settled."""
        return self._spectrum.lines(self._settled * signal)

    def marks(self, response: np.ndarray, drive: np.ndarray) -> Marks:
        """Judge one shot.

        Parameters
        ----------
        response : array, shape (samples, responses), m/s^2, of the whole shot
        drive : array, shape (samples, drives), V
        """
        return self.marks_of(self.error(response), drive)

    def marks_of(self, error: np.ndarray, drive: np.ndarray) -> Marks:
        """Judge one shot by its error.

        Parameters
        ----------
        error : array, shape (frames, outputs), m/s^2
            As of `error`.
        drive : array, shape (samples, drives), V
        """
        lines = self.lines(error)
        over = decibels(lines / self.limit)[self._judged]
        worst = over.argmax(axis=0)
        band_db, band_hz = self._bands(lines)
        first, phase = self._followed(self._reference - error)
        peak = np.maximum(np.abs(drive).max(axis=0), FAINT)
        return Marks(
            iae=np.abs(error).sum(axis=0),
            error_db=decibels(_rms(error) / _rms(self._reference)),
            worst_line_db=over.max(axis=0),
            worst_line_hz=self.frequency[self._judged][worst],
            worst_band_db=band_db,
            worst_band_hz=band_hz,
            overtone_db=first,
            thd_db=self._distortion(lines),
            phase_mean=phase.mean(axis=0),
            phase_peak=np.abs(phase).max(axis=0),
            headroom_db=decibels(self._limits.peak / peak),
            outputs=tuple(self._outputs),
            sensor=self.place.sensor,
        )

    def _judged_lines(self, overtones: int) -> np.ndarray:
        if self._root is None:
            return (self.frequency >= self._quality.above) & (self.frequency <= self._quality.judged_to)
        order = np.round(self.frequency / self._root)
        exact = np.abs(self.frequency - order * self._root) < 1e-6
        return exact & (order >= 2) & (order <= overtones + 1)

    def _bands(self, lines: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        number = ((self.frequency - self._quality.above) // BAND_WIDTH).astype(int)
        inside = np.unique(number[(self.frequency >= self._quality.above)])
        level = np.stack([_rms(np.abs(lines[number == band])) / self.limit for band in inside])
        worst = level.argmax(axis=0)
        return decibels(level.max(axis=0)), self._quality.above + (inside[worst] + 0.5) * BAND_WIDTH

    def _distortion(self, lines: np.ndarray) -> np.ndarray:
        high = self.frequency >= self._quality.above
        energy = (np.abs(lines[high]) ** 2).sum(axis=0) / (np.abs(self._wanted) ** 2).sum(axis=0)
        return decibels(np.sqrt(energy))

    def _followed(self, response: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Follow root and overtones along the reference's phase: levels (4, outputs) and the root's phase error."""
        parts, turned, loud = [], response, self._loud
        for _ in range(1, OVERTONES + 2):
            turned = turned * self._turn
            parts.append(self._averaged(turned))
        root = np.maximum(_rms(np.abs(parts[0][loud])), FAINT)
        levels = np.stack([decibels(_rms(np.abs(part[loud])) / root) for part in parts[1:]])
        return levels, np.angle(parts[0] * self._root_wanted.conj())[loud]

    def _averaged(self, signal: np.ndarray) -> np.ndarray:
        """Return the mean of a complex signal (frames, outputs) under the window, every `FOLLOWED` seconds."""
        reach, hop, spans = len(self._window) // 2, self._hop, len(self._loud)
        parts = len(self._window) // hop + 1
        weights = np.pad(self._window, (0, parts * hop - len(self._window))).reshape(parts, hop)
        turned = np.zeros((signal.shape[1], (spans + parts - 1) * hop), complex)
        turned[:, reach : reach + len(signal)] = signal.T
        pieces = turned.view(float).reshape(signal.shape[1], -1, hop, 2)
        sums = np.einsum("cshp,kh->pkcs", pieces, weights, optimize=True)  # by hop: BLAS does it
        level = np.sum([sums[:, part, :, part : part + spans] for part in range(parts)], axis=0)
        amplitude: np.ndarray = (level[0] + 1j * level[1]).T
        return amplitude

    def _averaging(self, rate: float) -> np.ndarray:
        size = np.abs(self._wanted).max(axis=1)
        lowest = self.frequency[np.argmax(size > SIGNIFICANT * size.max())]
        reach = min(round(PERIODS * rate / lowest), len(self._reference)) // (2 * self._hop) * self._hop
        window = blackmanharris(2 * reach + 1)
        normalised: np.ndarray = window / window.sum()
        return normalised


def _rms(signal: np.ndarray) -> np.ndarray:
    level: np.ndarray = np.sqrt(np.mean(np.abs(signal) ** 2, axis=0))
    return level
