"""Drives of the first and the last shot, in time and by line, and their head-room under the guard's limits."""

import numpy as np
from matplotlib.figure import Figure
from scipy.signal import lfilter

from rigkit.report import Plot, Table
from vibractl.config import Limits
from vibractl.decibels import FAINT, decibels
from vibractl.figures.lines import draw_envelope, largest_by_span, legend_above, look
from vibractl.figures.result import Result

SHOWN = 100.0
"""dB, of a drive's spectrum."""


def drive_plot(result: Result) -> Plot:
    """Draw each coil's drives over time, a row for each coil and a column for each shot, all on one scale."""
    figure = Figure(figsize=(8.0, 0.7 + 1.9 * len(result.coils)))
    grid = figure.subplots(len(result.coils), len(result.ends), sharex=True, sharey=True, squeeze=False)
    shot = result.made.shot
    time = (np.arange(shot.total) - shot.lead) / shot.rate
    for number, coil in enumerate(result.coils):
        for axes, each in zip(grid[number], result.ends, strict=True):
            draw_envelope(axes, time, each.drive[:, number], look(result, each))
            axes.set_title(f"Coil {coil}, shot {each.number}: peak {np.abs(each.drive[:, number]).max():.3g} V")
            axes.set_xlim(time[0], time[-1])
        grid[number, 0].set_ylabel("drive, V")
    for axes in grid[-1]:
        axes.set_xlabel("time, s")
    return Plot(figure, "Drives over time, as the smallest and the largest sample of each short span.")


def drive_spectrum_plot(result: Result) -> Plot:
    """Draw the spectra of each coil's drives over the lines that are learned."""
    figure = Figure(figsize=(8.0, 0.7 + 2.2 * len(result.coils)))
    rows = figure.subplots(len(result.coils), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    shot, (low, high) = result.made.shot, result.made.config.learning.band
    frequency = np.fft.rfftfreq(shot.frames, 1 / shot.rate)
    loudest = -np.inf
    learned = (frequency >= low) & (frequency <= high)
    for number, axes in enumerate(rows):
        for each in result.ends:
            size = np.abs(np.fft.rfft(each.drive[shot.window, number]))[learned] / shot.rate
            place, largest = largest_by_span(frequency[learned], size)
            axes.plot(place, decibels(largest), linewidth=0.8, **look(result, each))
            loudest = max(loudest, decibels(largest).max())
        axes.set_ylabel("dB re 1 V s")
        axes.set_title(f"Coil {result.coils[number]}: spectrum of the drive")
    rows[-1].set_xlabel("frequency, Hz")
    rows[0].set_ylim(bottom=max(rows[0].get_ylim()[0], loudest - SHOWN))
    rows[0].margins(x=0.01)
    legend_above(rows[0])
    return Plot(figure, "Spectra of the drives over the bins that are learned.")


def headroom_table(result: Result) -> Table:
    """Tell how far every drive stays under the guard's limits."""
    limits = result.made.config.limits
    bounds = (("peak", limits.peak, "V"), ("slew", limits.slew, "V/s"), ("RMS", limits.rms, "V"))
    rows = []
    for end in result.ends:
        for number, coil in enumerate(result.coils):
            reached = extremes(end.drive[:, number], limits, result.made.shot.rate)
            cells = [f"{value:.4g} {unit}" for value, (_, _, unit) in zip(reached, bounds, strict=True)]
            room = [f"{headroom(value, bound):.1f} dB" for value, (_, bound, _) in zip(reached, bounds, strict=True)]
            pairs = [cell for pair in zip(cells, room, strict=True) for cell in pair]
            rows.append((f"coil {coil}, shot {end.number}", *pairs))
    head = [cell for name, bound, unit in bounds for cell in (name, f"under {bound:g} {unit}")]
    return Table(("drive", *head), tuple(rows))


def headroom(value: float, limit: float) -> float:
    """Return how far a value is under its limit, dB."""
    return float(decibels(limit / max(value, FAINT)))


def extremes(drive: np.ndarray, limits: Limits, rate: float) -> tuple[float, float, float]:
    """Return the largest size, rate of change and running RMS of a drive, as the guard measures them.

    Parameters
    ----------
    drive : array, shape (samples,), V
    limits : Limits
    rate : float, samples/s

    Returns
    -------
    three floats, V, V/s, V
    """
    drive = np.asarray(drive, dtype=float)
    forget = -np.expm1(-1.0 / (limits.rms_seconds * rate))
    mean = lfilter([forget], [1.0, forget - 1.0], drive**2)
    slew = np.abs(np.diff(drive, prepend=0.0)).max() * rate
    return float(np.abs(drive).max()), float(slew), float(np.sqrt(mean.max()))
