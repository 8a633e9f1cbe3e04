"""A run as a MATLAB file of version 5 (`load` of any MATLAB or Octave): one structure, `run`, through scipy.io."""

from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import savemat

from rigkit.run_folder import read_quality
from vibractl import far_field
from vibractl.export.content import Content
from vibractl.far_field import FarField
from vibractl.model_file import UNITS

LARGEST = 2**31 - 1
"""Bytes of one variable in a file of this version."""


def write_mat(path: Path, content: Content) -> None:
    """Write model, reference, table of the shots, and shots, with the units beside them.

    Parameters
    ----------
    path : Path
        Written in place.
    content : Content

    Raises
    ------
    ValueError : the shots are more than such a file holds.
    """
    shots = [_shot(content, number) for number in content.files]
    size = sum(shot["data"].nbytes for shot in shots)
    if size > LARGEST:
        raise ValueError(f"{len(shots)} shots are {size} bytes, must be <= {LARGEST} in a MATLAB file; name fewer")
    matrix = content.matrix
    model: dict[str, Any] = {name: getattr(matrix, name) for name in UNITS}
    model |= {"units": UNITS, "provenance": _text_fields(dict(matrix.provenance))}
    run = {
        "about": _text_fields(content.about),
        "rate": content.rate,
        "rate_unit": "samples/s",
        "model": model,
        "reference": {
            "names": _cells(content.reference_names),
            "unit": "m/s^2",
            "first_sample": content.lead + 1,
            "data": content.reference,
        },
        **({} if content.far is None else {"far_field": _far_field(content.far)}),
        "quality": _quality(content),
        "shots": np.array([tuple(shot.values()) for shot in shots], [(name, object) for name in shots[0]]),
    }
    savemat(str(path), {"run": run}, do_compression=True, oned_as="column", long_field_names=True)


def _far_field(far: FarField) -> dict[str, Any]:
    matrix = far.late
    parts = {name: getattr(matrix, name) for name in ("frequency", "response", "variance", "coherence")}
    return parts | {"delay": far.delay, "units": {"frequency": "Hz", **far_field.UNITS}}


def _shot(content: Content, number: int) -> dict[str, Any]:
    record = content.shot(number)
    provenance = _text_fields(dict(record.provenance))
    return {
        "number": number,
        "names": _cells(record.names),
        "units": _cells(record.units),
        "data": record.data,
        "provenance": provenance,
    }


def _quality(content: Content) -> dict[str, Any]:
    """Return the columns of `qc.csv`, numbers where they are all numbers; an empty cell is NaN."""
    rows = read_quality(content.path)
    columns: dict[str, Any] = {}
    for name in rows[0] if rows else ():
        cells = [row[name] for row in rows]
        try:
            columns[name] = np.array([float(cell or "nan") for cell in cells])
        except ValueError:
            columns[name] = _cells(cells)
    return columns


def _cells(texts: Any) -> np.ndarray:
    """Return texts as a column of cells, shape (texts,)."""
    cells = np.empty(len(texts), object)
    cells[:] = list(texts)
    return cells


def _text_fields(texts: dict[str, str]) -> dict[str, str]:
    """Return texts under names that MATLAB takes: letters, digits and underscores, a letter first."""
    return {"".join(c if c.isalnum() and c.isascii() else "_" for c in f"{name}"): text for name, text in texts.items()}
