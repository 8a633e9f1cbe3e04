"""What the page draws of a run, twice a second: how the error is distributed, and its spectrum."""

from collections.abc import Iterator

import numpy as np
from scipy.signal import welch

from rigkit.service.show import Axis, Curves, Panel, Trace
from stagectl.daemon.stage.monitor import WINDOW
from stagectl.experiments.piezo.setup import Setup
from stagectl.experiments.piezo.spectrum_plots import HIGHEST
from stagectl.tracking import tracking

SEGMENT = 2_048
"""Samples of a segment of a spectrum: lines 5 Hz apart."""
BINS = 40
"""Of a histogram, at most."""
_STEP = 1e-12
"""m: errors that differ by less are the same."""


def panels(error: np.ndarray, made: Setup) -> Iterator[tuple[str, Panel]]:
    """Draw the errors of the last second, by name.

    Parameters
    ----------
    error : array, shape (samples, axes), m
    made : Setup
    """
    axes = made.config.stage.axes
    if len(error):
        yield "histogram", histogram(error, axes)
    if len(error) >= SEGMENT:
        yield "spectrum", spectrum(error, axes, made.timeline.rate)


def histogram(error: np.ndarray, axes: tuple[str, ...]) -> Curves:
    """Draw how the errors of each axis are distributed, with their mean absolute errors in the title.

    Bins are whole numbers of the sensor's steps wide, where the errors show any, so that steps make no comb.

    Parameters
    ----------
    error : array, shape (samples, axes), m
        At least one sample.
    axes : tuple of str
    """
    step = min(_step(column) for column in error.T)
    largest = max(float(np.abs(error).max()), _STEP)
    width = step * np.ceil(2 * largest / (BINS - 2) / step)
    count = np.ceil(largest / width)
    edges = width * np.arange(-count - 0.5, count + 1)
    middle = (edges[:-1] + edges[1:]) / 2
    columns = list(zip(axes, error.T, strict=True))
    parts = (np.histogram(column, edges)[0] / len(column) for _, column in columns)
    traces = tuple(Trace(axis, middle, part) for axis, part in zip(axes, parts, strict=True))
    means = ", ".join(f"{axis} {1e6 * tracking(column).mae:.3f}" for axis, column in columns)
    title = f"Error, last {WINDOW:g} s, MAE {means} µm"
    return Curves(title, Axis("error", "m"), Axis("part of the samples", "1"), traces)


def _step(error: np.ndarray) -> float:
    """Return the smallest difference between two of the errors, m."""
    gaps = np.diff(np.unique(np.round(error / _STEP)))
    return _STEP * float(gaps.min()) if len(gaps) else _STEP


def spectrum(error: np.ndarray, axes: tuple[str, ...], rate: float) -> Curves:
    """Draw the amplitude spectral density of each axis' error.

    Parameters
    ----------
    error : array, shape (samples, axes), m
    axes : tuple of str
    rate : float, samples/s
    """
    frequency, density = welch(error, rate, nperseg=min(SEGMENT, len(error)), axis=0)
    shown = (frequency > 0) & (frequency <= HIGHEST)
    size = np.sqrt(density[shown])
    traces = tuple(Trace(axis, frequency[shown], column) for axis, column in zip(axes, size.T, strict=True))
    ends = Axis("frequency", "Hz", "log"), Axis("error", "m/√Hz", "log")
    return Curves(f"Spectrum of the error, last {WINDOW:g} s", *ends, traces)
