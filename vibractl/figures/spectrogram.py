"""Spectrograms of the first and the last response, on a scale that ends at the objective."""

import numpy as np
from matplotlib.figure import Figure
from scipy.signal import ShortTimeFFT
from scipy.signal.windows import blackmanharris

from rigkit.report import Plot
from vibractl.decibels import decibels
from vibractl.figures.result import Result, Shot
from vibractl.spectrum import Decimator

WINDOW = 0.25
"""s: lines 4 Hz apart, while a chirp of 10 Hz/s stays within one."""
COLUMNS = 400
ROW = 2.0
"""Hz, spacing of the transform; the window is padded with silence to it."""
TOP = 650.0
"""Hz, of the figure."""


def spectrogram_plot(result: Result) -> Plot:
    """Draw the responses, a row for each side and a column for each shot, all on one scale."""
    sides, ends, quality = result.sides, result.ends, result.made.config.quality
    figure = Figure(figsize=(8.0, 0.6 + 2.5 * len(sides)))
    grid = figure.subplots(len(sides), len(ends), sharex=True, sharey=True, squeeze=False)
    decimator = Decimator(result.made.config.learning.decimation)
    loudest = _levels(result, _reference(result))[1].max(axis=(0, 1))
    for column, shot in enumerate(ends):
        time, size = _levels(result, decimator.apply(np.asarray(shot.response, dtype=float)))
        for row, side in enumerate(sides):
            axes = grid[row, column]
            image = axes.imshow(
                decibels(size[:, :, row] / loudest[row]),
                extent=(time[0], time[-1], 0.0, TOP),
                vmin=quality.objective,
                vmax=0.0,
                aspect="auto",
                origin="lower",
                interpolation="nearest",
            )
            axes.grid(visible=False)
            axes.set_title(f"{result.sensor.capitalize()} {side}, shot {shot.number}")
            axes.set_xlim(0, result.seconds)
    for axes in grid[-1]:
        axes.set_xlabel("time, s")
    for axes in grid[:, 0]:
        axes.set_ylabel("frequency, Hz")
    figure.colorbar(image, ax=grid, extend="min", label="level re reference, dB", pad=0.02, aspect=30)
    return Plot(figure, _caption(quality.objective, ends))


def _caption(objective: float, ends: tuple[Shot, ...]) -> str:
    compared = " before and after learning" if len(ends) > 1 else ""
    return (
        f"Spectrograms of the response{compared}. The darkest colour is the objective, {objective:g} dB under the "
        "reference's largest level, and all below it: where the objective holds, nothing but the reference itself is "
        f"seen. Windows of {WINDOW:g} s (Blackman-Harris)."
    )


def _reference(result: Result) -> np.ndarray:
    """Return the reference where it lies in the shot, (samples, sides), at the learner's rate."""
    shot, step = result.made.shot, result.made.config.learning.decimation
    placed = np.zeros((shot.total // step, len(result.sides)))
    placed[shot.lead // step :][: len(result.reference)] = result.reference
    return placed


def _levels(result: Result, signal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return times from the reference's first sample, s, and magnitudes (frequencies, times, sides), 0 Hz to `TOP`."""
    time, size = magnitudes(signal, result.rate, COLUMNS, ROW)
    return time - result.made.shot.lead / result.made.shot.rate, size


def magnitudes(signal: np.ndarray, rate: float, columns: int, row: float) -> tuple[np.ndarray, np.ndarray]:
    """Return a spectrogram: its times (columns,), s, and magnitudes (frequencies, columns, sides), 0 Hz to `TOP`.

    Parameters
    ----------
    signal : array, shape (samples, sides), any unit
    rate : float, samples/s
    columns : int
        About so many.
    row : float, Hz
        Spacing of the frequencies.
    """
    frames = round(WINDOW * rate)
    hop = max(1, len(signal) // columns)
    transform = ShortTimeFFT(blackmanharris(frames), hop, rate, mfft=round(rate / row))
    spectrum = np.abs(transform.stft(signal, axis=0))
    return transform.t(len(signal)), np.moveaxis(spectrum[transform.f <= TOP], 1, 2)
