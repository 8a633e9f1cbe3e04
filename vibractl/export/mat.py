"""A run as a MATLAB file of version 5 (`load` of any MATLAB or Octave): one structure, `run`, through scipy.io."""

from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import savemat

from ctlblocks.recording import Recording
from rigkit.run_folder import read_quality
from vibractl import far_field
from vibractl.export.content import Content
from vibractl.far_field import FarField
from vibractl.model_file import UNITS
from vibractl.transfer_matrix import TransferMatrix

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
    _refuse_too_large(content)
    read = lru_cache(maxsize=1)(content.shot)
    shots = [_shot(read, number) for number in content.files]
    run = {
        "about": _text_fields(content.about),
        "rate": content.rate,
        "rate_unit": "samples/s",
        **({} if content.matrix is None else {"model": _model(content.matrix)}),
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
    savemat(str(path), {"run": run}, oned_as="column", long_field_names=True)  # compressing would hold all of it
    if path.stat().st_size > LARGEST:
        raise ValueError(
            f"the run takes {path.stat().st_size} bytes, must be <= {LARGEST} in a MATLAB file; name fewer"
        )


def _model(matrix: TransferMatrix) -> dict[str, Any]:
    parts: dict[str, Any] = {name: getattr(matrix, name) for name in UNITS}
    return parts | {"units": UNITS, "provenance": _text_fields(dict(matrix.provenance))}


class _OnDemand:
    """A part of a shot that is read when scipy writes it, so that one shot at a time is in memory."""

    def __init__(self, part: Callable[[], np.ndarray]) -> None:
        self._part = part

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        """Read it."""
        return np.asarray(self._part(), dtype)


def _refuse_too_large(content: Content) -> None:
    """Raise ValueError where the samples alone are more than the file holds; all shots of a run are like the first."""
    size = len(content.files) * content.shot(min(content.files)).data.nbytes
    if size > LARGEST:
        raise ValueError(
            f"{len(content.files)} shots are {size} bytes, must be <= {LARGEST} in a MATLAB file; name fewer"
        )


def _far_field(far: FarField) -> dict[str, Any]:
    matrix = far.late
    parts = {name: getattr(matrix, name) for name in ("frequency", "response", "variance", "coherence")}
    return parts | {"delay": far.delay, "units": {"frequency": "Hz", **far_field.UNITS}}


def _shot(read: Callable[[int], Recording], number: int) -> dict[str, Any]:
    return {
        "number": number,
        "names": _OnDemand(lambda: _cells(read(number).names)),
        "units": _OnDemand(lambda: _cells(read(number).units)),
        "data": _OnDemand(lambda: read(number).data),
        "provenance": _OnDemand(lambda: _structure(_text_fields(dict(read(number).provenance)))),
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


def _structure(fields: dict[str, str]) -> np.ndarray:
    """Return fields as scipy writes a structure; an empty array where there are none."""
    return np.array([tuple(fields.values())], [(name, object) for name in fields]) if fields else np.zeros((0, 0))


def _text_fields(texts: dict[str, str]) -> dict[str, str]:
    """Return texts under names that MATLAB takes: letters, digits and underscores, a letter first."""
    return {"".join(c if c.isalnum() and c.isascii() else "_" for c in f"{name}"): text for name, text in texts.items()}
