"""What the page draws of a run: convergence, errors against the limit, certificates, spectrograms."""

from dataclasses import replace

import numpy as np

from rigkit.service.rig import Desk
from rigkit.service.show import Axis, Curves, Image, Table, Trace
from vibractl.daemon.history import History
from vibractl.decibels import decibels
from vibractl.figures.lines import largest_by_span
from vibractl.figures.spectrogram import magnitudes
from vibractl.learning.algorithm import Algorithm
from vibractl.quality import Judge, Marks
from vibractl.setup import Setup
from vibractl.spectrum import Decimator

COLUMNS, ROW = 150, 4.0
"""Of a spectrogram: about so many, and Hz from one row to the next."""
WORST, BAND = 8, 20.0
"""Lines in the table: so many, of each band of so many Hz the worst."""
_FREQUENCY = Axis("frequency", "Hz")
_SHOT = Axis("shot", "1")


class Panels:
    """Draws a run on a desk, shot by shot.

    Parameters
    ----------
    desk : Desk
    made : Setup
    """

    def __init__(self, desk: Desk, made: Setup) -> None:
        self._desk, self._judge, self._objective = desk, Judge(made, made.judged), made.config.quality.objective
        step = made.config.learning.decimation
        self._decimator, self._rate = Decimator(step), made.shot.rate / step
        names = [f"{made.judged.sensor} {sensor + 1}" for sensor in made.judged.sensors]
        self._sides = dict(enumerate(names, start=1))
        self._loudest = magnitudes(made.judged.reference, self._rate, COLUMNS, ROW)[1].max(axis=(0, 1))
        self._worst, self._iae = History(1 + len(names)), History(1 + len(names))
        self._first: list[Trace] = []

    def draw(self, shot: int, marks: Marks, response: np.ndarray, algorithm: Algorithm) -> None:
        """Draw a shot.

        Parameters
        ----------
        shot : int
        marks : Marks
        response : array, shape (samples, sensors), m/s^2 or Pa
            Where shots are judged.
        algorithm : Algorithm
            After it has learned from the shot.
        """
        self._worst.add(shot, *marks.worst_line_db)
        self._iae.add(shot, *marks.iae)
        self._convergence()
        over = self._levels(response)
        self._spectra(shot, over)
        self._spectrograms(shot, response)
        self._certificate(algorithm)
        self._table(over, algorithm)
        self._absolute_error()

    def _convergence(self) -> None:
        limit = Trace("objective", np.array([0.0, self._worst.rows[-1, 0]]), np.zeros(2), "limit")
        worst = self._over_shots(self._worst)
        over = Axis("worst bin over the objective", "dB")
        self._desk.show("convergence", Curves("Convergence", _SHOT, over, (*worst, limit)))

    def _absolute_error(self) -> None:
        error = Axis("sum of |error|", self._judge.place.unit, "log")
        self._desk.show("error", Curves("Integrated absolute error", _SHOT, error, tuple(self._over_shots(self._iae))))

    def _over_shots(self, history: History) -> list[Trace]:
        shots, *columns = history.rows.T
        named = zip(self._sides.values(), columns, strict=True)
        return [Trace(side, *largest_by_span(shots, column)) for side, column in named]

    def _levels(self, response: np.ndarray) -> np.ndarray:
        """Return the errors of the judged lines, (lines, sides), dB re reference."""
        judge = self._judge
        lines = np.abs(judge.lines(judge.error(response)))[judge.judged]
        return decibels(lines / judge.reference_level)

    def _spectra(self, shot: int, level: np.ndarray) -> None:
        frequency = self._judge.frequency[self._judge.judged]
        limit = Trace("objective", frequency[[0, -1]], np.full(2, self._objective), "limit")
        axes = _FREQUENCY, Axis("error re reference", "dB")
        for side, column in zip(self._sides, level.T, strict=True):
            last = Trace(f"shot {shot}", *largest_by_span(frequency, column))
            if len(self._first) < side:
                self._first.append(replace(last, role="reference"))
            title = f"Error of {self._sides[side]}, bin by bin"
            before = (self._first[side - 1],) if len(self._worst.rows) > 1 else ()
            self._desk.show(f"spectrum_{side}", Curves(title, *axes, (*before, last, limit)))

    def _certificate(self, algorithm: Algorithm) -> None:
        at, largest = largest_by_span(algorithm.law.matrix.frequency, algorithm.daring.certificate)
        limit = Trace("1: it converges below", at[[0, -1]], np.ones(2), "limit")
        bound = Axis("bound on the error map", "1")
        traces = Trace("certificate", at, largest), limit
        self._desk.show("certificate", Curves("Certificate, bin by bin", _FREQUENCY, bound, traces))

    def _table(self, level: np.ndarray, algorithm: Algorithm) -> None:
        """Show the worst lines, one of each band, with their certificates."""
        frequency = self._judge.frequency[self._judge.judged]
        bands = [np.flatnonzero(frequency // BAND == band) for band in np.unique(frequency // BAND)]
        found = [(lines[level[lines, n].argmax()], n) for lines in bands for n in range(level.shape[1])]
        worst = sorted(found, key=lambda place: -level[place])[:WORST]
        certificate = np.interp(frequency, algorithm.law.matrix.frequency, algorithm.daring.certificate)
        rows = tuple(
            (
                self._sides[n + 1],
                round(float(frequency[line]), 1),
                round(float(level[line, n] - self._objective), 1),
                round(float(certificate[line]), 2),
            )
            for line, n in worst
        )
        head = "side", "bin, Hz", "over the objective, dB", "certificate"
        self._desk.show("lines", Table("Worst bins", head, rows))

    def _spectrograms(self, shot: int, response: np.ndarray) -> None:
        heard = np.asarray(response[:, list(self._judge.place.sensors)], dtype=float)
        time, size = magnitudes(self._decimator.apply(heard), self._rate, COLUMNS, ROW)
        span, rows = (float(time[0]), float(time[-1])), (0.0, ROW * (len(size) - 1))
        axes = Axis("time", "s"), _FREQUENCY, Axis("level re reference", "dB")
        ends = ("first", "last") if len(self._worst.rows) == 1 else ("last",)
        for side, levels in zip(self._sides, np.moveaxis(size, 2, 0), strict=True):
            shown = np.maximum(decibels(levels / self._loudest[side - 1]), 1.25 * self._objective)
            title = f"{self._sides[side].capitalize()}, shot {shot}"
            for end in ends:
                image = Image(title, *axes, span, rows, (self._objective, 0.0), shown)
                self._desk.show(f"{end}_spectrogram_{side}", image)
