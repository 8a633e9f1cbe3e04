"""What was identified, in words: for a terminal, and for a notebook."""

from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from calibration.fit_measures import Fit
from calibration.state_space.model import InnovationModel
from calibration.subspace.naming import by_name
from calibration.subspace.outliers import outlier_notes

if TYPE_CHECKING:
    from calibration.subspace.identified import Identified

_FIT_HEAD = ("output", "free run, %", "one step, %", "one step from rest, %")
_PREDICTION_HEAD = ("output", *_FIT_HEAD[2:])
_MODE_HEAD = ("natural frequency, Hz", "+-", "damping ratio", "+-")


def title(found: "Identified") -> str:
    """Return a line: size, rate and fit."""
    model, own = found.model, found.fit
    inputs = f"{model.inputs or 'no'} input{'s' * (model.inputs != 1)}"
    free = f"free run {own.free_run.nrmse.mean():.1f} %, " if model.inputs and model.is_stable else ""
    kind = "" if model.is_stable else "unstable, "
    return (
        f"order {found.core.order}, {inputs}, {model.outputs} output{'s' * (model.outputs > 1)}, "
        f"{model.rate:g} samples/s: {kind}{free}one step {own.one_step.nrmse.mean():.1f} %"
    )


def summary(found: "Identified") -> str:
    """Return what a person wants to know first: fits, modes with their errors, and what is to be thought of them."""
    samples = sum(len(each) for each in found.drives)
    past, future = found.horizon
    lines = [
        title(found),
        f"from {samples} samples in {len(found.drives)} record{'s' * (len(found.drives) > 1)}, "
        f"by {found.method}, horizon {past} and {future}",
        *_delay_lines(found),
        *fit_lines(found.model, found.fit),
        *_aligned(_MODE_HEAD, _mode_rows(found)),
        *_sentences(found),
    ]
    return "\n".join(lines)


def _sentences(found: "Identified") -> tuple[str, ...]:
    told = (*outlier_notes(found.outliers), *found.diagnosis.sentences)
    return by_name(told, found.model.input_names, found.model.output_names)


def _delay_lines(found: "Identified") -> list[str]:
    late = [f"{name} {each}" for name, each in zip(found.model.input_names, found.delays, strict=True) if each]
    return [f"dead time, samples: {', '.join(late)}"] if late else []


def fit_lines(model: InnovationModel, fit: Fit) -> list[str]:
    """Return a heading and a line an output: NRMSE of free run and prediction."""
    return _aligned(*_fit_table(model, fit))


def html(found: "Identified") -> str:
    """Return the summary as a notebook shows it."""
    said = "".join(f"<li>{escape(sentence)}</li>" for sentence in _sentences(found))
    tables = _table(*_fit_table(found.model, found.fit)) + _table(_MODE_HEAD, _mode_rows(found))
    return f"<p><b>{escape(title(found))}</b></p>{tables}<ul>{said}</ul>"


def _fit_table(model: InnovationModel, fit: Fit) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Return a heading and rows; what runs freely without inputs is nothing."""
    ahead = (fit.one_step.nrmse, fit.from_rest.nrmse)
    head, columns = (_FIT_HEAD, (fit.free_run.nrmse, *ahead)) if model.inputs else (_PREDICTION_HEAD, ahead)
    rows = zip(model.output_names, *columns, strict=True)
    return head, [(name, *(known(value, ".2f") for value in values)) for name, *values in rows]


def known(value: float, form: str, unit: str = "") -> str:
    """Return a figure with its unit; a dash where there is none, as of an unstable model's free run."""
    return f"{value:{form}}{unit}" if np.isfinite(value) else "-"


def _mode_rows(found: "Identified") -> list[tuple[str, ...]]:
    poles = found.poles()
    return [
        (
            f"{pole['frequency']:.5g}",
            f"{pole['frequency_error']:.2g}",
            f"{pole['damping']:.4f}",
            f"{pole['damping_error']:.2g}" if pole["pole"].imag else "-",
        )
        for pole in poles
    ]


def _aligned(head: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    widths = [max(len(cell) for cell in column) for column in zip(head, *rows, strict=True)]
    return [
        "  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in (head, *rows)
    ]


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    cells = "".join(f"<th>{escape(cell)}</th>" for cell in head)
    body = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in rows)
    return f"<table><thead><tr>{cells}</tr></thead><tbody>{body}</tbody></table>"


def frequencies(model: InnovationModel, samples: int, count: int = 400) -> np.ndarray:
    """Return frequencies, Hz, that show the modes of a model and end at half its rate: shape (count + modes,).

    Parameters
    ----------
    model : InnovationModel
    samples : int
        Of the longest record, of which one period is the slowest that it tells of.
    count : int, optional
    """
    half, found = model.rate / 2, model.modes.frequency
    low = max(model.rate / samples, min([half / 1000, *found[(found > 0) & np.isfinite(found)] / 10]))
    grid: np.ndarray = np.unique(
        np.concatenate([np.geomspace(low, half, count), found[(found > low) & (found < half)]])
    )
    return grid
