"""A run as CSV files that say what they hold: responses as real and imaginary parts a line, and signals in time."""

import csv
import io
import json
from pathlib import Path

import numpy as np

from ctlblocks import recording
from ctlblocks.recording import Recording
from rigkit import atomic
from vibractl.export.content import Content
from vibractl.model_file import UNITS
from vibractl.transfer_matrix import TransferMatrix


def write_csv(folder: Path, content: Content) -> list[Path]:
    """Write `responses.csv`, `reference.csv` and `shot-0000.csv` ..., each in one step.

    Parameters
    ----------
    folder : Path
        There already.
    content : Content

    Returns
    -------
    list of Path
    """
    written = [folder / "responses.csv", folder / "reference.csv"]
    atomic.write(written[0], responses_text(content.matrix, content.about))
    units = ("m/s^2",) * len(content.sides)
    about = content.about | {"reference_begins_at_sample": str(content.lead)}
    recording.write(written[1], Recording(content.reference_names, units, content.rate, content.reference, about))
    for number in content.files:
        record = content.shot(number)
        written.append(folder / f"shot-{number:04d}.csv")
        said = {**about, "shot": str(number), **record.provenance}
        recording.write(written[-1], Recording(record.names, record.units, record.rate, record.data, said))
    return written


def responses_text(matrix: TransferMatrix, about: dict[str, str]) -> str:
    """Write a transfer matrix as Touchstone does, a row for each frequency, under a line that says what it is.

    The first line is "#" and JSON, the second names each column with its unit: the frequency, then for each element
    (by response, then by drive) the real and the imaginary part, the variance and the coherence.  Nine digits keep
    single precision; the frequency keeps all of its own.

    Parameters
    ----------
    matrix : TransferMatrix
    about : dict
        Where it comes from.

    Returns
    -------
    str
    """
    first = {
        "quantity": "frequency response, acceleration over drive",
        "format": "RI",
        "responses": matrix.outputs,
        "drives": matrix.inputs,
        "bins": len(matrix.frequency),
        "provenance": about | {name: text for name, text in matrix.provenance.items() if "\n" not in text},
    }
    head, columns = [f"frequency [{UNITS['frequency']}]"], [matrix.frequency]
    for output in range(matrix.outputs):
        for drive in range(matrix.inputs):
            name = f"G_{output + 1}_{drive + 1}"
            element = matrix.response[:, output, drive]
            for part, unit, values in (
                ("re", UNITS["response"], element.real),
                ("im", UNITS["response"], element.imag),
                ("variance", UNITS["variance"], matrix.variance[:, output, drive]),
                ("coherence", UNITS["coherence"], matrix.coherence[:, output, drive]),
            ):
                head.append(f"{name}_{part} [{unit}]")
                columns.append(values)
    text = io.StringIO()
    text.write(f"# {json.dumps(first)}\n")
    csv.writer(text, lineterminator="\n").writerow(head)
    for frequency, *cells in np.column_stack(columns).tolist():
        text.write(",".join([repr(frequency), *(f"{cell:.9g}" for cell in cells)]) + "\n")
    return text.getvalue()
