"""Two models side by side: figures, and a report to look at."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from calibration.model_comparison import (
    COMPARED_HEAD,
    DIFFERING_HEAD,
    EXPECTED_95,
    LETTERS,
    Comparison,
    bands,
    compared_rows,
    differing_rows,
    farthest,
)
from rigkit.figure_style import COLOURS, LIMIT, styled
from rigkit.report import Fact, Plot, Report, Section, Table


def comparison_figures(found: Comparison, far: Comparison | None = None) -> dict[str, Any]:
    """Return what `--json` writes; `far` compares the far fields where both models have one."""
    return {
        **({} if far is None else {"far_field": comparison_figures(far)}),
        "first": found.first_name,
        "second": found.second_name,
        "lines": len(found.frequency),
        "median_relative_difference": float(np.median(found.relative)),
        "mean_normalised_difference": float(found.normalised.mean()),
        "bands": [
            {
                "band_hz": [low, high],
                "lines": int(inside.sum()),
                "median_relative_difference": float(np.median(found.relative[inside])),
                "relative_difference_95": float(np.percentile(found.relative[inside], 95)),
                "mean_normalised_difference": float(found.normalised[inside].mean()),
                "normalised_difference_95": float(np.percentile(found.normalised[inside], 95)),
            }
            for low, high, inside in bands(found)
        ],
        "farthest": [
            {
                "frequency_hz": float(found.frequency[line]),
                "relative_difference": float(found.relative[line]),
                "normalised_difference": float(found.normalised[line].max()),
            }
            for line in farthest(found)
        ],
        "frequency_hz": found.frequency,
        "relative_difference": found.relative,
        "normalised_difference": found.normalised,
    }


def comparison_report(found: Comparison, far: Comparison | None = None) -> Report:
    """Put the report of a comparison together; `far` compares the far fields where both models have one."""
    within = float(np.mean(found.normalised <= EXPECTED_95))
    facts = (
        Fact("bins in common", f"{len(found.frequency)}"),
        Fact("median difference", f"{100 * np.median(found.relative):.2g} %"),
        Fact("normalised difference, mean", f"{found.normalised.mean():.2g}"),
        Fact("elements within their uncertainty", f"{100 * within:.0f} % (95 % if nothing changed)"),
    )
    with styled():
        sections = _sections(found, "")
        if far is not None:
            sections += _sections(far, " of the far field")
    return Report("Two models compared", f"{found.first_name} and {found.second_name}", facts, sections)


def _sections(found: Comparison, of_what: str) -> tuple[Section, ...]:
    size, _ = LETTERS[found.quantity]
    return (
        Section(f"Both models{of_what}", "", (Plot(_both(found), "Magnitude of each element, output from input."),)),
        Section(
            f"Difference{of_what}",
            "The normalised difference is |difference|² over the sum of both variances: 1 on average, and below "
            "3.0 on 95 of 100 elements, if the vibrator is unchanged and both variances are right.",
            (Plot(_difference(found), f"Relative to {size} of the first, and against the uncertainty of both."),),
            (
                Table(COMPARED_HEAD, tuple(compared_rows(found))),
                Table(DIFFERING_HEAD, tuple(differing_rows(found))),
            ),
        ),
    )


def _both(found: Comparison) -> Figure:
    outputs, inputs = found.first.shape[1:]
    figure = Figure(figsize=(8.0, 0.8 + 2.3 * outputs))
    grid = figure.subplots(outputs, inputs, sharex=True, sharey=True, squeeze=False)
    models = ((found.first, found.first_name, COLOURS[0]), (found.second, found.second_name, COLOURS[1]))
    for output in range(outputs):
        for drive in range(inputs):
            axes = grid[output, drive]
            for model, name, colour in models:
                size = np.maximum(np.abs(model[:, output, drive]), 1e-6)
                axes.plot(found.frequency, 20 * np.log10(size), color=colour, linewidth=0.8, label=name)
            axes.set_title(f"{output + 1} from {drive + 1}")
    for left in grid[:, 0]:
        left.set_ylabel(f"dB re {LETTERS[found.quantity][1]}")
    for lowest in grid[-1]:
        lowest.set_xlabel("Hz")
    grid[0, 0].legend()
    return figure


def _difference(found: Comparison) -> Figure:
    figure = Figure(figsize=(8.0, 5.5))
    upper, lower = figure.subplots(2, 1, sharex=True)
    upper.semilogy(found.frequency, 100 * found.relative, linewidth=0.9)
    upper.set_ylabel(f"difference, % of {LETTERS[found.quantity][0]}")
    for number, (output, drive) in enumerate(np.ndindex(found.first.shape[1:])):
        value = np.maximum(found.normalised[:, output, drive], 1e-4)
        colour = COLOURS[number % len(COLOURS)]
        lower.semilogy(found.frequency, value, ".", color=colour, markersize=2, label=f"{output + 1} from {drive + 1}")
    lower.axhline(EXPECTED_95, label="95 % below, if nothing changed", **LIMIT)
    lower.set(ylabel="normalised difference", xlabel="Hz")
    lower.legend(ncols=3)
    return figure
