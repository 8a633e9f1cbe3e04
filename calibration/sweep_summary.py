"""What a calibration found, in figures: how certain the lines are, and what a second pass says about the first."""

import math
from typing import Any

import numpy as np

from calibration.far_field_report import far_field_figures
from calibration.multisine_report import LEVEL_HEAD, level_table
from calibration.vibrator import Calibration
from vibractl.transfer_matrix import TransferMatrix, norm

BANDS = (0.0, 100.0, 200.0, 400.0, math.inf)
"""Hz, between which lines are counted together."""
WORST, APART = 5, 0.05
"""Lines named one by one, and how far from each other they are at least, by the logarithm of frequency."""


def relative_deviation(matrix: TransferMatrix) -> np.ndarray:
    """Return the standard deviation of G, Frobenius, over its largest singular value; shape (bins,), 1."""
    deviation: np.ndarray = np.sqrt(matrix.variance.sum(axis=(-2, -1))) / norm(matrix.response)
    return deviation


def band_rows(matrix: TransferMatrix) -> list[tuple[str, ...]]:
    """Return a row of text for each band: lines, median and worst relative deviation, where, least coherence."""
    relative = relative_deviation(matrix)
    rows: list[tuple[str, ...]] = []
    for low, high in zip(BANDS, BANDS[1:], strict=False):
        inside = (matrix.frequency >= low) & (matrix.frequency < high)
        if inside.any():
            frequency, there = matrix.frequency[inside], relative[inside]
            worst = int(there.argmax())
            rows.append(
                (
                    f"{frequency[0]:g} to {frequency[-1]:g} Hz",
                    f"{inside.sum()}",
                    f"{100 * np.median(there):.3g}",
                    f"{100 * there[worst]:.3g}",
                    f"{frequency[worst]:g}",
                    f"{_least_diagonal(matrix.coherence[inside]):.5f}",
                )
            )
    return rows


BAND_HEAD = ("band", "lines", "median deviation, %", "worst, %", "at, Hz", "least coherence on the diagonal")


def worst_rows(matrix: TransferMatrix) -> list[tuple[str, ...]]:
    """Return a row of text for each of the least certain lines, each from another place."""
    relative, frequency = relative_deviation(matrix), matrix.frequency
    worst: list[int] = []
    for line in map(int, np.argsort(relative)[::-1]):
        if all(abs(np.log(frequency[line] / frequency[each])) > APART for each in worst):
            worst.append(line)
        if len(worst) == WORST:
            break
    size = norm(matrix.response)
    return [(f"{matrix.frequency[n]:g}", f"{100 * relative[n]:.3g}", f"{size[n]:.3g}") for n in worst]


WORST_HEAD = ("least certain bins, Hz", "deviation, %", "|G|, m/s^2/V")


def sweep_figures(found: Calibration) -> dict[str, Any]:
    """Return what `--json` writes."""
    relative = relative_deviation(found.matrix)
    figures: dict[str, Any] = {
        "lines": len(found.matrix.frequency),
        "seconds_of_signal": found.seconds,
        "identification_seconds": found.seconds,
        "median_relative_deviation": float(np.median(relative)),
        "worst_relative_deviation": float(relative.max()),
        "least_coherence": _least_diagonal(found.matrix.coherence),
    }
    if found.far is not None:
        figures["far_field"] = far_field_figures(found.far)
    if len(found.passes) > 1:
        difference = pass_difference(found)
        figures["first_pass_median_difference"] = float(np.median(difference))
        figures["first_pass_worst_difference"] = float(difference.max())
        figures["first_grid_worst_interpolation"] = float(grid_error(found)[1].max(initial=0.0))
    if found.levels is not None:
        figures["levels_db"] = [dict(zip(LEVEL_HEAD, row, strict=True)) for row in level_table(found.levels).rows]
        figures["loudest_line_db"] = found.loudest
        figures["measured_again_hz"] = found.tones
    if found.over is not None:
        figures["loudest_line_over_limit_db"] = found.over
    return figures


def pass_difference(found: Calibration) -> np.ndarray:
    """Return by how much the first pass, interpolated, misses each line of the second, relative to |G|; (bins,), 1."""
    first, last = found.passes
    missed: np.ndarray = norm(first.at(last.frequency).response - last.response) / norm(last.response)
    return missed


def grid_error(found: Calibration) -> tuple[np.ndarray, np.ndarray]:
    """Return what interpolating the first grid misses at the lines the second added, by the second pass alone.

    Returns
    -------
    frequency : array, shape (lines added,), Hz
    missed : array, shape (lines added,), 1
        Relative to |G|.
    """
    first, last = found.passes
    old = np.isin(last.frequency, first.frequency)
    coarse = TransferMatrix(last.frequency[old], last.response[old], last.variance[old], last.coherence[old])
    new = last.frequency[~old]
    missed = norm(coarse.at(new).response - last.response[~old]) / norm(last.response[~old])
    return new, missed


def _least_diagonal(coherence: np.ndarray) -> float:
    return float(np.diagonal(coherence, axis1=1, axis2=2).min())
