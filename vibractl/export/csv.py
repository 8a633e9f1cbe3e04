"""A run as CSV files that say what they hold: responses as real and imaginary parts a line, and signals in time."""

import csv
import io
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ctlblocks import recording
from rigkit import atomic
from rigkit.export.parquet_file import Column
from vibractl import far_field
from vibractl.export.content import Content
from vibractl.model_file import UNITS
from vibractl.transfer_matrix import TransferMatrix


@dataclass(frozen=True)
class Kind:
    """What a file of responses says of them.

    Parameters
    ----------
    quantity, letter, outputs, inputs : str
    units : mapping of str to str
    """

    quantity: str
    letter: str
    outputs: str
    inputs: str
    units: Mapping[str, str]


RESPONSES = Kind("frequency response, acceleration over drive", "G", "responses", "drives", UNITS)
FAR_FIELD = Kind(
    "frequency response, sound pressure over acceleration", "T", "hydrophones", "responses", far_field.UNITS
)


def write_csv(folder: Path, content: Content) -> list[Path]:
    """Write `responses.csv` and `far-field.csv` if known, `reference.csv`, `shot-0000.csv` ..., each in one step.

    Parameters
    ----------
    folder : Path
        There already.
    content : Content

    Returns
    -------
    list of Path
    """
    written = []
    if content.matrix is not None:
        written.append(folder / "responses.csv")
        atomic.write(written[-1], responses_text(content.matrix, content.about))
    if content.far is not None:
        written.append(folder / "far-field.csv")
        atomic.write(written[-1], responses_text(content.far.late, content.about, FAR_FIELD))
    for name, record in content.recordings():
        written.append(folder / f"{name}.csv")
        recording.write(written[-1], record)
    return written


def responses_text(matrix: TransferMatrix, about: dict[str, str], kind: Kind = RESPONSES) -> str:
    """Write a transfer matrix as Touchstone does, a row for each frequency, under a line that says what it is.

    The first line is "#" and JSON, the second names each column with its unit: the frequency, then for each element
    (by response, then by drive) the real and the imaginary part, the variance and the coherence.  Nine digits keep
    single precision; the frequency keeps all of its own.

    Parameters
    ----------
    matrix : TransferMatrix
    about : dict
        Where it comes from.
    kind : Kind
        Of response.

    Returns
    -------
    str
    """
    first = response_words(matrix, about, kind)
    columns = response_columns(matrix, kind)
    text = io.StringIO()
    text.write(f"# {json.dumps(first)}\n")
    csv.writer(text, lineterminator="\n").writerow([f"{each.name} [{each.unit}]" for each in columns])
    for frequency, *cells in np.column_stack([each.values for each in columns]).tolist():
        text.write(",".join([repr(frequency), *(f"{cell:.9g}" for cell in cells)]) + "\n")
    return text.getvalue()


def response_words(matrix: TransferMatrix, about: dict[str, str], kind: Kind = RESPONSES) -> dict[str, object]:
    """Return what a file of responses says of them.

    Parameters
    ----------
    matrix : TransferMatrix
    about : dict
    kind : Kind
    """
    return {
        "quantity": kind.quantity,
        "format": "RI",
        kind.outputs: matrix.outputs,
        kind.inputs: matrix.inputs,
        "bins": len(matrix.frequency),
        "provenance": about | {name: text for name, text in matrix.provenance.items() if "\n" not in text},
    }


def response_columns(matrix: TransferMatrix, kind: Kind = RESPONSES) -> list[Column]:
    """Return frequency, then real and imaginary part, variance and coherence of each element, a column each.

    Parameters
    ----------
    matrix : TransferMatrix
    kind : Kind
    """
    columns = [Column("frequency", "Hz", matrix.frequency)]
    for output in range(matrix.outputs):
        for drive in range(matrix.inputs):
            name = f"{kind.letter}_{output + 1}_{drive + 1}"
            element = matrix.response[:, output, drive]
            for part, unit, values in (
                ("re", kind.units["response"], element.real),
                ("im", kind.units["response"], element.imag),
                ("variance", kind.units["variance"], matrix.variance[:, output, drive]),
                ("coherence", kind.units["coherence"], matrix.coherence[:, output, drive]),
            ):
                columns.append(Column(f"{name}_{part}", unit, values))
    return columns
