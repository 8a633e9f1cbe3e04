"""The model that a run learns with: its elements, how well they are known, and what that certifies."""

import numpy as np
from matplotlib.figure import Figure

from rigkit.figure_style import COLOURS
from rigkit.report import Plot
from vibractl.decibels import decibels
from vibractl.figures.lines import BOUND, legend_above
from vibractl.setup import Setup
from vibractl.transfer_matrix import TransferMatrix

DEVIATIONS = 2.0


def magnitude_plot(model: TransferMatrix) -> Plot:
    """Draw |G| of each element with its band of uncertainty, rows for accelerometers and columns for coils."""
    outputs, inputs = model.outputs, model.inputs
    figure = Figure(figsize=(8.0, 0.6 + 2.3 * outputs))
    grid = figure.subplots(outputs, inputs, sharex=True, sharey=True, squeeze=False)
    for output in range(outputs):
        for coil in range(inputs):
            axes, size = grid[output, coil], np.abs(model.response[:, output, coil])
            doubt = DEVIATIONS * np.sqrt(
                model.variance[:, output, coil] / 2
            )  # half of it is across, and turns the phase
            low, high = decibels(np.maximum(size - doubt, 1e-2 * size)), decibels(size + doubt)
            axes.fill_between(model.frequency, low, high, color=COLOURS[4], alpha=0.6, linewidth=0, label="2 σ")
            axes.plot(model.frequency, decibels(size), linewidth=1.0, label="|G|")
            axes.set_title(f"Coil {coil + 1} to side {output + 1}")
    for axes in grid[:, 0]:
        axes.set_ylabel("|G|, dB re 1 m/s²/V")
    for axes in grid[-1]:
        axes.set_xlabel("frequency, Hz")
    legend_above(grid[0, 0])
    return Plot(figure, "The measured transfer matrix, with two standard deviations of its magnitude.")


def trust_plot(model: TransferMatrix, made: Setup) -> Plot:
    """Draw the coherence of every element, and the certificate of the first stage of gains line by line."""
    figure = Figure(figsize=(8.0, 5.2))
    above, below = figure.subplots(2, 1, sharex=True)
    for output in range(model.outputs):
        for coil in range(model.inputs):
            number = (output * model.inputs + coil) % len(COLOURS)
            label = f"{coil + 1} to {output + 1}"
            above.plot(model.frequency, model.coherence[:, output, coil], color=COLOURS[number], lw=0.9, label=label)
    above.set_ylim(min(0.9, model.coherence.min() - 0.02), 1.005)
    above.set_ylabel("coherence")
    above.set_title("Coherence")
    legend_above(above)
    law = made.law
    learned = law.active > 0
    frequency, bound = law.matrix.frequency[learned], made.learner().algorithm.daring.certificate[learned]
    below.plot(frequency, bound, "o" if learned.sum() < 100 else "-", linewidth=1.0, markersize=5)
    below.axhline(1.0, **BOUND, label="certified below 1")
    below.set_ylim(0.0, max(1.1, 1.05 * bound.max()))
    below.set_ylabel("bound on contraction")
    below.set_xlabel("frequency, Hz")
    below.set_title(f"Part of the error that one update leaves, at most (K = {law.gains.at(0):g})")
    legend_above(below)
    certified = np.count_nonzero(bound < 1)
    return Plot(
        figure,
        "Above: part of the response that the drive explains, coil to side. Below: ||I - K G G⁺|| with two standard "
        f"deviations of G; {certified} of {len(bound)} learned bins are certified to converge.",
    )
