"""What the page draws of a run: convergence, errors against the limit, certificates, spectrograms."""

from collections.abc import Iterator, Sequence

import numpy as np

from rigkit.service.rig import Desk
from rigkit.service.show import Axis, Curves, Image, Trace
from vibractl.algorithm import Algorithm
from vibractl.figures.lines import largest_by_span
from vibractl.figures.spectrogram import magnitudes
from vibractl.quality import FAINT, Judge, Marks, decibels
from vibractl.setup import Setup
from vibractl.spectrum import Decimator

COLUMNS, ROW = 150, 4.0
"""Of a spectrogram: about so many, and Hz from one row to the next."""
DEEPEST = -80.0
"""dB, end of the spectrogram's colours."""
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
        self._sides = [f"{made.judged.sensor} {sensor + 1}" for sensor in made.judged.sensors]
        self._shots: list[int] = []
        self._worst: list[np.ndarray] = []
        self._iae: list[np.ndarray] = []

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
        first = not self._shots
        self._shots.append(shot)
        self._worst.append(marks.worst_line_db)
        self._iae.append(marks.iae)
        self._convergence()
        self._errors(response)
        self._certificate(algorithm)
        for image in self._spectrograms(response):
            name = image.title.replace(" ", "_")
            if first:
                self._desk.show(f"first_{name}", image)
            self._desk.show(f"last_{name}", image)

    def _convergence(self) -> None:
        limit = Trace("limit", np.array([0, self._shots[-1]]), np.zeros(2), "limit")
        worst, iae = self._over_shots(self._worst), self._over_shots(self._iae)
        over = Axis("worst line over the limit", "dB")
        self._desk.show("convergence", Curves("Worst line", _SHOT, over, (*worst, limit)))
        error = Axis("sum of |error|", self._judge.place.unit, "log")
        self._desk.show("error", Curves("Integrated absolute error", _SHOT, error, tuple(iae)))

    def _over_shots(self, values: Sequence[np.ndarray]) -> list[Trace]:
        columns = np.array(values).T
        return [Trace(side, np.array(self._shots), column) for side, column in zip(self._sides, columns, strict=True)]

    def _errors(self, response: np.ndarray) -> None:
        judge = self._judge
        size = np.abs(judge.lines(judge.error(response)))[judge.judged] / judge.reference_level
        frequency = judge.frequency[judge.judged]
        traces = []
        for side, column in zip(self._sides, size.T, strict=True):
            at, largest = largest_by_span(frequency, column)
            traces.append(Trace(side, at, decibels(largest)))
        limit = Trace("limit", frequency[[0, -1]], np.full(2, self._objective), "limit")
        level = Axis("error re reference", "dB")
        self._desk.show("spectrum", Curves("Error of each line", _FREQUENCY, level, (*traces, limit)))

    def _certificate(self, algorithm: Algorithm) -> None:
        at, largest = largest_by_span(algorithm.law.matrix.frequency, algorithm.certificate)
        limit = Trace("limit", at[[0, -1]], np.ones(2), "limit")
        bound = Axis("bound on the error map", "1")
        traces = Trace("certificate", at, largest), limit
        self._desk.show("certificate", Curves("Certificate: below 1 a line converges", _FREQUENCY, bound, traces))

    def _spectrograms(self, response: np.ndarray) -> Iterator[Image]:
        heard = np.asarray(response[:, list(self._judge.place.sensors)], dtype=float)
        time, size = magnitudes(self._decimator.apply(heard), self._rate, COLUMNS, ROW)
        span, rows = (float(time[0]), float(time[-1])), (0.0, ROW * (len(size) - 1))
        axes = Axis("time", "s"), _FREQUENCY, Axis("level re the largest", "dB")
        for side, levels in zip(self._sides, np.moveaxis(size, 2, 0), strict=True):
            relative = decibels(levels / max(float(levels.max()), FAINT))
            shown = np.maximum(relative, 1.25 * DEEPEST)
            yield Image(f"spectrogram {side}", *axes, span, rows, (DEEPEST, 0.0), shown)
