"""CSV files: a line of JSON behind '#' (rate and provenance), a row of names and units, a row of numbers a sample."""

import csv
import json
from array import array
from pathlib import Path
from typing import Any

import numpy as np

_CELLS = {"float32": "%.9g", "float64": "%r"}  # reads back to the same number: nine digits, or Python's shortest


def write(path: Path, data: np.ndarray, rate: float, about: dict[str, Any]) -> None:
    """Write samples, shape (frames, channels), float32 or float64, and `about`."""
    kind, (frames, channels) = data.dtype.name, data.shape
    first = {"rate": rate, "frames": frames, "dtype": kind, "provenance": about["provenance"]}
    row = ",".join([_CELLS[kind]] * channels) + "\n"
    with path.open("w", encoding="utf-8", newline="") as file:
        file.write(f"# {json.dumps(first)}\n")
        heads = [f"{name} [{unit}]" for name, unit in zip(about["names"], about["units"], strict=True)]
        csv.writer(file, lineterminator="\n").writerow(heads)
        for start in range(0, frames, 4096):
            file.writelines([row % tuple(sample) for sample in data[start : start + 4096].tolist()])


def read(path: Path) -> tuple[np.ndarray, float, dict[str, Any]]:
    """Read samples, rate and `about`; ValueError names the row, and the column and the cell where it is one."""
    with path.open(encoding="utf-8-sig") as file:
        said = preamble(file.readline())
        heads = [head.strip().removesuffix("]").partition(" [") for head in next(csv.reader([file.readline()]), [])]
        values = array("d")
        for number, line in enumerate(file, 3):
            cells, done = line.split(","), len(values)
            try:
                values.extend(map(float, cells))
            except ValueError:
                column = len(values) - done
                raise ValueError(f"row {number}, column {column + 1}: {cells[column]!r}, must be a number") from None
            if len(cells) != len(heads) or not line.isascii() or "_" in line or (line[-1] != "\n" and said["frames"]):
                raise ValueError(f"row {number}: {line[:40]!r}, must be {len(heads)} numbers and the end of a line")
    data = np.frombuffer(values).reshape(-1, max(len(heads), 1))
    if said["frames"] not in (None, len(data)):
        raise ValueError(f"row 1 says {said['frames']} samples, there are {len(data)}")
    with np.errstate(over="ignore"):
        data = data.astype(said["dtype"])
    names, units = [name for name, _, _ in heads], [unit or "1" for _, _, unit in heads]
    return data, said["rate"], {"names": names, "units": units, "provenance": said["provenance"]}


def preamble(line: str) -> dict[str, Any]:
    """Return what a first line of JSON says: rate, frames, dtype, provenance; ValueError where it is none."""
    default: dict[str, Any] = {"rate": None, "frames": None, "dtype": "float64", "provenance": {}}
    try:
        first = dict(json.loads(line.removeprefix("#")))
    except (ValueError, TypeError, RecursionError):
        first = {}
    if "rate" not in first or first.keys() - default:
        raise ValueError(f'row 1: {line[:80]!r}, must be as # {{"rate": 44100}}, with {", ".join(default)} alone')
    return default | first
