"""What a calibration found of the far field, drawn: the transfer, how certain it is, and how late the sound comes."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from rigkit.figure_style import COLOURS
from rigkit.report import Plot, Section, Table
from vibractl.decibels import decibels
from vibractl.far_field import FarField

HEAD = (
    "hydrophone",
    "late, ms",
    "in phase, Pa per m/s²",
    "median deviation, %",
    "95 % of bins within, %",
    "coherence",
)


def far_field_section(far: FarField) -> Section:
    """Put the section of a far field together."""
    text = (
        "T of P = T Y, from what accelerometers feel to what a hydrophone hears, fitted to the same records. "
        "Phases are drawn without the delay. Two standard deviations are shaded."
    )
    caption = "Magnitude and phase, hydrophone from accelerometer."
    return Section("Far field", text, (Plot(_drawn(far), caption),), (Table(HEAD, tuple(far_field_rows(far))),))


def far_field_rows(far: FarField) -> list[tuple[str, ...]]:
    """Return a row of text for each hydrophone."""
    matrix = far.prompt
    rows: list[tuple[str, ...]] = []
    for hydrophone, delay in enumerate(far.delay):
        together = np.median(np.abs(matrix.response[:, hydrophone].sum(axis=1)))
        deviation = 100 * relative_deviation(far)[:, hydrophone]
        rows.append(
            (
                f"{hydrophone + 1}",
                f"{1000 * delay:.2f}",
                f"{together:.4g}",
                f"{np.median(deviation):.3g}",
                f"{np.percentile(deviation, 95):.3g}",
                f"{matrix.coherence[:, hydrophone].min():.5f}",
            )
        )
    return rows


def relative_deviation(far: FarField) -> np.ndarray:
    """Return the standard deviation of each row of T re its size, (bins, hydrophones), 1."""
    size = np.linalg.norm(far.prompt.response, axis=2)
    deviation: np.ndarray = np.sqrt(far.prompt.variance.sum(axis=2)) / size
    return deviation


def far_field_figures(far: FarField) -> dict[str, Any]:
    """Return what `--json` writes of a far field."""
    deviation = relative_deviation(far)
    return {
        "delay_seconds": far.delay,
        "median_relative_deviation": np.median(deviation, axis=0),
        "relative_deviation_95": np.percentile(deviation, 95, axis=0),
        "least_coherence": far.prompt.coherence.min(axis=(0, 2)),
    }


def _drawn(far: FarField) -> Figure:
    matrix = far.prompt
    figure = Figure(figsize=(8.0, 2.6 * matrix.outputs + 1.6))
    heights = [2, 1] * matrix.outputs
    axes = figure.subplots(2 * matrix.outputs, 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    for hydrophone, sensor in np.ndindex(matrix.outputs, matrix.inputs):
        level, phase = axes[2 * hydrophone : 2 * hydrophone + 2]
        colour = COLOURS[sensor % len(COLOURS)]
        response, band = matrix.response[:, hydrophone, sensor], 2 * np.sqrt(matrix.variance[:, hydrophone, sensor])
        size, angle = np.abs(response), np.degrees(np.angle(response))
        doubt = np.degrees(np.minimum(band / size, np.pi))
        shade = {"color": colour, "alpha": 0.3, "linewidth": 0}
        level.fill_between(
            matrix.frequency, decibels(np.maximum(size - band, size / 10)), decibels(size + band), **shade
        )
        level.plot(matrix.frequency, decibels(size), color=colour, linewidth=0.9, label=f"accelerometer {sensor + 1}")
        phase.fill_between(matrix.frequency, angle - doubt, angle + doubt, **shade)
        phase.plot(matrix.frequency, angle, ".", color=colour, markersize=1.2)
    for hydrophone, delay in enumerate(far.delay):
        level, phase = axes[2 * hydrophone : 2 * hydrophone + 2]
        level.set_title(f"hydrophone {hydrophone + 1}, {1000 * delay:.2f} ms late")
        level.set_ylabel("dB re 1 Pa/(m/s²)")
        phase.set(ylim=(-190, 190), yticks=(-180, 0, 180), ylabel="phase, °")
    axes[0].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), frameon=False, ncols=matrix.inputs)
    axes[-1].set_xlabel("Hz")
    return figure
