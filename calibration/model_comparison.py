"""How two models of one rig differ, line by line and by band, against their uncertainty."""

from dataclasses import dataclass, replace

import numpy as np

from vibractl.far_field import FarField
from vibractl.transfer_matrix import TransferMatrix, norm

BANDS = (0.0, 100.0, 200.0, 400.0, np.inf)
"""Hz, between which lines are counted together."""
WORST = 8
"""Lines named one by one ..."""
APART = 2.0
"""Hz ... at least so far from each other."""
LETTERS = {"G": ("|G|", "1 m/s²/V"), "T": ("|T|", "1 Pa/(m/s²)")}
"""How a quantity, and the unit of its level, are written."""
EXPECTED_95 = 3.0
"""Normalised squared difference that 5 % of elements exceed if variances are right: chi-square, two degrees, halved."""


class ComparisonError(ValueError):
    """Two models that cannot be compared."""


@dataclass(frozen=True)
class Comparison:
    """Two models on the lines that both cover.

    Parameters
    ----------
    first_name, second_name : str
    frequency : array, shape (lines,), Hz
        Of the coarser one, where both have a response.
    first, second : complex arrays, shape (lines, outputs, inputs), m/s^2 per V
    relative : array, shape (lines,), 1
        Largest singular value of the difference over that of the first.
    normalised : array, shape (lines, outputs, inputs), 1
        |difference|^2 over the sum of both variances: about 1 on average where the models agree within them.
    quantity : "G", or "T" of the far field, Pa per m/s^2
    """

    first_name: str
    second_name: str
    frequency: np.ndarray
    first: np.ndarray
    second: np.ndarray
    relative: np.ndarray
    normalised: np.ndarray
    quantity: str = "G"


def compare(first: TransferMatrix, second: TransferMatrix, first_name: str, second_name: str) -> Comparison:
    """Compare two models of one rig.

    Parameters
    ----------
    first, second : TransferMatrix
    first_name, second_name : str
        What to call them.

    Raises
    ------
    ComparisonError : of different rigs or sizes, or without a band in common.
    """
    rigs = [model.provenance.get("rig") for model in (first, second)]
    if rigs[0] != rigs[1]:
        raise ComparisonError(
            f"{first_name} was measured on rig {rigs[0]!r}, {second_name} on rig {rigs[1]!r}; must be the same"
        )
    if first.response.shape[1:] != second.response.shape[1:]:
        sizes = [f"{model.outputs} accelerometers and {model.inputs} coils" for model in (first, second)]
        raise ComparisonError(f"{first_name} has {sizes[0]}, {second_name} has {sizes[1]}; must be the same")
    low = max(first.frequency[0], second.frequency[0])
    high = min(first.frequency[-1], second.frequency[-1])
    inside = [model.frequency[(model.frequency >= low) & (model.frequency <= high)] for model in (first, second)]
    lines = min(inside, key=len)
    lines = lines[~(first.lacks(lines) | second.lacks(lines))]
    if not len(lines):
        raise ComparisonError(f"{first_name} and {second_name} have no band in common")
    a, b = first.at(lines), second.at(lines)
    difference = b.response - a.response
    doubt = np.maximum(a.variance + b.variance, np.finfo(float).tiny)
    return Comparison(
        first_name,
        second_name,
        lines,
        a.response,
        b.response,
        norm(difference) / norm(a.response),
        np.abs(difference) ** 2 / doubt,
    )


def compare_far_fields(first: FarField, second: FarField, first_name: str, second_name: str) -> Comparison:
    """Compare the far fields of two models, seen with the first one's delays; otherwise as `compare`.

    Raises
    ------
    ComparisonError : of different sizes, or without a band in common.
    """
    if first.prompt.response.shape[1:] != second.prompt.response.shape[1:]:
        sizes = [f"{far.hydrophones} hydrophones and {far.prompt.inputs} accelerometers" for far in (first, second)]
        raise ComparisonError(f"{first_name} has {sizes[0]}, {second_name} has {sizes[1]}; must be the same")
    moved = replace(second.prompt, response=second.later(first.delay))
    return replace(compare(first.prompt, moved, first_name, second_name), quantity="T")


COMPARED_HEAD = (
    "band", "bins", "median difference, %", "95 % of bins within, %", "normalised, mean", "95 % within (3.0)"
)  # fmt: skip
DIFFERING_HEAD = ("farthest apart, Hz", "difference, %", "normalised, worst element", "element")


def bands(found: Comparison) -> list[tuple[float, float, np.ndarray]]:
    """Return first and last line of each band that has any, Hz, and which lines are in it, (lines,) of bool."""
    split = []
    for low, high in zip(BANDS, BANDS[1:], strict=False):
        inside = (found.frequency >= low) & (found.frequency < high)
        if inside.any():
            there = found.frequency[inside]
            split.append((float(there[0]), float(there[-1]), inside))
    return split


def compared_rows(found: Comparison) -> list[tuple[str, ...]]:
    """Return a row of text for each band."""
    return [
        (
            f"{low:g} to {high:g} Hz",
            f"{inside.sum()}",
            f"{100 * np.median(found.relative[inside]):.3g}",
            f"{100 * np.percentile(found.relative[inside], 95):.3g}",
            f"{found.normalised[inside].mean():.3g}",
            f"{np.percentile(found.normalised[inside], 95):.3g}",
        )
        for low, high, inside in bands(found)
    ]


def farthest(found: Comparison) -> np.ndarray:
    """Return which lines differ most against their uncertainty, none near another one; shape (at most WORST,)."""
    worst = found.normalised.max(axis=(1, 2))
    chosen: list[int] = []
    for line in np.argsort(worst)[::-1]:
        if all(abs(found.frequency[line] - found.frequency[other]) >= APART for other in chosen):
            chosen.append(int(line))
        if len(chosen) == WORST:
            break
    return np.array(chosen)


def differing_rows(found: Comparison) -> list[tuple[str, ...]]:
    """Return a row of text for each of the lines that differ most."""
    rows: list[tuple[str, ...]] = []
    for line in farthest(found):
        element = np.unravel_index(found.normalised[line].argmax(), found.normalised.shape[1:])
        rows.append(
            (
                f"{found.frequency[line]:g}",
                f"{100 * found.relative[line]:.3g}",
                f"{found.normalised[line].max():.3g}",
                f"{element[0] + 1} from {element[1] + 1}",
            )
        )
    return rows
