"""What a calibration found, drawn: the response with its uncertainty, and how its method came to it."""

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from calibration.far_field_report import far_field_section
from calibration.multisine_report import levels_section
from calibration.preload import clearance, preload_frequencies
from calibration.refinement import interpolation_error
from calibration.sweep_summary import (
    BAND_HEAD,
    WORST_HEAD,
    band_rows,
    grid_error,
    pass_difference,
    relative_deviation,
    sweep_figures,
    worst_rows,
)
from calibration.vibrator import Calibration
from calibration.vibrator_sweep import TOLERANCE
from rigkit.figure_style import COLOURS, LIMIT, styled
from rigkit.report import Fact, Plot, Report, Section, Table
from vibractl.characterisation_config import Characterisation
from vibractl.config import RigConfig
from vibractl.decibels import rms
from vibractl.transfer_matrix import TransferMatrix

MOST_COLUMNS = 3
"""Elements of a row of the transfer matrix that have room beside each other."""


def sweep_report(found: Calibration, config: RigConfig) -> Report:
    """Put the report of a calibration together."""
    settings, figures = config.characterisation, sweep_figures(found)
    facts = (
        Fact("bins", f"{figures['lines']}"),
        Fact("signal", f"{found.seconds / 60:.1f} min emitted"),
        Fact("median relative deviation", f"{100 * figures['median_relative_deviation']:.2g} %"),
        *_drive_facts(found, settings),
    )
    with styled():
        sections = _sections(found, config)
    subtitle = f"{config.rig.name}, {found.matrix.provenance['date']}"
    return Report("Vibrator calibration", subtitle, facts, tuple(sections))


def _drive_facts(found: Calibration, settings: Characterisation) -> Iterator[Fact]:
    if found.levels is None:
        yield Fact("preload and probe", f"{settings.preload:g} V and {settings.probe:g} V a side")
        return
    if not settings.quiet:
        loudest = "" if found.loudest is None else f", {found.loudest:.1f} dB"
        preload = "as the reference needs" if settings.around == "reference" else f"{settings.operating:g} V rms a side"
        yield Fact("preload and loudest bin", f"{preload}{loudest}")
    if found.over is not None:
        yield Fact("loudest bin re the limit", f"{found.over:.1f} dB", found.over <= 0 if settings.quiet else None)


def _sections(found: Calibration, config: RigConfig) -> list[Section]:
    certainty = "Two standard deviations are shaded.  Noise is in them, and what had not settled; drift is not."
    if found.levels is not None:
        certainty = "Two standard deviations are shaded.  Noise and distortion are in them; slow drift is not."
    sections = [
        Section(
            "Transfer matrix", certainty, (Plot(bode_figure(found.matrix), "Magnitude and phase, output from input."),)
        ),
        Section(
            "Certainty",
            "",
            (
                Plot(
                    certainty_figure(found.matrix),
                    "Relative standard deviation, and coherence of each output and input.",
                ),
            ),
            (Table(BAND_HEAD, tuple(band_rows(found.matrix))), Table(WORST_HEAD, tuple(worst_rows(found.matrix)))),
        ),
    ]
    if found.far is not None:
        sections.append(far_field_section(found.far))
    if found.levels is not None:
        return [*sections, levels_section(found.levels, found.tones)]
    if config.characterisation.preload:
        text = "The preload makes way for the probe, but stays near the middle of its band."
        caption = "Where the preload was for each probe, and how far its harmonics and mixing products stayed away."
        sections.append(Section("Preload", text, (Plot(_preload_map(found.matrix.frequency, config), caption),)))
    if len(found.passes) > 1:
        text = "Intervals are halved until interpolation is predicted to be within the limit, or the finest is reached."
        caption = (
            "Spacing of the bins; what interpolating the first grid misses, as predicted by the first pass and as "
            "measured in the second; and how far the passes are apart, which is drift and settling as well."
        )
        sections.append(Section("Refined grid", text, (Plot(_grid(found), caption),)))
    return sections


def bode_figure(matrix: TransferMatrix) -> Figure:
    """Draw magnitude and phase of every element, or of each output's strongest, two standard deviations shaded."""
    is_wide = matrix.inputs > MOST_COLUMNS
    columns = 1 if is_wide else matrix.inputs
    figure = Figure(figsize=(8.0, 3.0 * matrix.outputs + 1.5))
    rows, heights = 2 * matrix.outputs, [2, 1] * matrix.outputs
    axes = figure.subplots(rows, columns, sharex=True, squeeze=False, height_ratios=heights)
    for output, column in np.ndindex(matrix.outputs, columns):
        level, phase = axes[2 * output, column], axes[2 * output + 1, column]
        drive = _strongest(matrix, output) if is_wide else column
        if is_wide:
            others = _decibels(np.abs(np.delete(matrix.response[:, output], drive, axis=1)))
            level.plot(matrix.frequency, others, linewidth=0.4, color="0.65")
        lowest = _draw_element(level, phase, matrix, output, drive)
        level.set_ylim(bottom=(min(lowest, others.min()) if is_wide else lowest) - 10)
        level.set_title(f"response {output + 1} from drive {drive + 1}" + ", thin: from the others" * is_wide)
        if column == 0:
            level.set_ylabel("dB re 1 m/s²/V")
            phase.set_ylabel("phase, °")
        if output == matrix.outputs - 1:
            phase.set_xlabel("Hz")
    return figure


def _draw_element(level: Axes, phase: Axes, matrix: TransferMatrix, output: int, drive: int) -> float:
    """Draw magnitude and phase of an element; return the smallest magnitude, dB, where the shade may go on below."""
    response = matrix.response[:, output, drive]
    size, band = np.abs(response), 2 * np.sqrt(matrix.variance[:, output, drive])
    _shade(level, matrix.frequency, _decibels(size - band), _decibels(size + band))
    level.plot(matrix.frequency, _decibels(size), linewidth=0.9)
    angle, doubt = np.degrees(np.angle(response)), np.degrees(np.minimum(band / size, np.pi))
    _shade(phase, matrix.frequency, angle - doubt, angle + doubt)
    phase.plot(matrix.frequency, angle, ".", markersize=1.2)
    phase.set(ylim=(-190, 190), yticks=(-180, 0, 180))
    return float(_decibels(size).min())


def certainty_figure(matrix: TransferMatrix) -> Figure:
    """Draw how certain every line is, and the coherence of every element, or of each output's strongest."""
    elements = list(np.ndindex(matrix.outputs, matrix.inputs))
    if matrix.inputs > MOST_COLUMNS:
        elements = [(output, _strongest(matrix, output)) for output in range(matrix.outputs)]
    figure = Figure(figsize=(8.0, 5.0))
    upper, lower = figure.subplots(2, 1, sharex=True)
    upper.semilogy(matrix.frequency, 100 * relative_deviation(matrix))
    upper.set_ylabel("deviation of G, %")
    for number, (output, drive) in enumerate(elements):
        colour = COLOURS[number % len(COLOURS)]
        doubt = np.maximum(1 - matrix.coherence[:, output, drive], 1e-12)
        lower.semilogy(matrix.frequency, doubt, color=colour, linewidth=0.9, label=f"{output + 1} from {drive + 1}")
    lower.invert_yaxis()
    lower.set(ylabel="1 - coherence", xlabel="Hz")
    lower.legend(loc="lower center", bbox_to_anchor=(0.5, 1.02), ncols=8)
    return figure


def _strongest(matrix: TransferMatrix, output: int) -> int:
    """Return the drive that an output answers most."""
    return int(rms(matrix.response[:, output]).argmax())


def _preload_map(frequency: np.ndarray, config: RigConfig) -> Figure:
    preload = preload_frequencies(frequency, config.characterisation.preload_band)
    figure = Figure(figsize=(8.0, 4.5))
    upper, lower = figure.subplots(2, 1, sharex=True)
    upper.plot(frequency, preload, ".", markersize=2)
    upper.set_ylabel("preload, Hz")
    lower.plot(frequency, clearance(frequency, preload), ".", markersize=2, color=COLOURS[1])
    lower.set(ylabel="clearance, Hz", xlabel="probe, Hz", ylim=(0, None))
    return figure


def _grid(found: Calibration) -> Figure:
    first, last = found.passes
    new, missed = grid_error(found)
    middle = (first.frequency[:-1] + first.frequency[1:]) / 2
    figure = Figure(figsize=(8.0, 5.5))
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[1, 2])
    upper.plot(last.frequency[:-1], np.diff(last.frequency), drawstyle="steps-post")
    upper.set_ylabel("spacing, Hz")
    lower.semilogy(middle, 100 * interpolation_error(first.frequency, first.response), label="predicted, first pass")
    lower.semilogy(last.frequency, 100 * pass_difference(found), ".", markersize=3, label="first pass against second")
    lower.semilogy(new, 100 * missed, "x", markersize=4, label="first grid interpolated, second pass alone")
    lower.axhline(100 * TOLERANCE, label="limit of the second pass", **LIMIT)
    lower.set(ylabel="relative to |G|, %", xlabel="Hz")
    lower.legend()
    return figure


def _shade(axes: Axes, frequency: np.ndarray, low: np.ndarray, high: np.ndarray) -> None:
    axes.fill_between(frequency, low, high, color=COLOURS[4], alpha=0.5, linewidth=0)


def _decibels(size: np.ndarray) -> np.ndarray:
    level: np.ndarray = 20 * np.log10(np.maximum(size, 1e-6))
    return level
