"""Damaged CSV files, our own and those of others, and what each must be read as if it is."""

import csv
import json
import random
import re
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from ctlblocks import recording
from ctlblocks.recording import Recording, RecordingError
from rigkit.even_time import seconds_of
from rigkit.foreign_record import read_channels
from rigkit.table_rows import COMMENT
from tests.fuzz.judge import is_accepted
from tests.fuzz.mutation import mutated, of_text

NUMBER = re.compile(r"\s*[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?\s*")


def cases(folder: Path) -> Callable[[int], bool]:
    """Return what reads our own damaged file of a number, and says whether it was accepted."""
    sound, path = _ours(), folder / "x.csv"

    def case(number: int) -> bool:
        chance = random.Random(number)
        content = mutated(chance.choice(sound), chance, sound, of_text)
        path.write_bytes(content)
        return is_accepted(lambda: recording.read(path), partial(_check_ours, content), RecordingError)

    return case


def foreign_cases(folder: Path) -> Callable[[int], bool]:
    """Return what reads the damaged file of another program, and says whether it was accepted."""
    sound = _others()

    def case(number: int) -> bool:
        chance = random.Random(number)
        path = folder / f"x.{chance.choice(('csv', 'txt'))}"
        content = mutated(chance.choice(sound), chance, sound, of_text)
        path.write_bytes(content)
        rate = chance.choice((None, 100.0))
        check = partial(_check_theirs, content, rate)
        return is_accepted(lambda: read_channels(path, ["1", "2"], rate), check, RecordingError)

    return case


def _rows(text: str, separator: str | None, width: int) -> list[list[float]]:
    """Read rows of numbers by their letters."""
    found = []
    for line in text.removesuffix("\n").split("\n"):
        cells = (
            next(csv.reader([line], delimiter=separator, strict=True))
            if separator
            else re.split("[ \t]+", line.strip(" \t"))
        )
        assert len(cells) == width, f"a row of {len(cells)} cells"
        assert all(NUMBER.fullmatch(cell) for cell in cells), f"{line!r} is no row of numbers"
        found.append([float(cell) for cell in cells])
    return found


def _check_ours(content: bytes, read: Recording) -> None:
    first, _, rest = content.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n").partition("\n")
    said = json.loads(first.removeprefix("#"))
    assert read.rate == float(said["rate"]), f"{read.rate} samples/s"
    rows = np.array(_rows(rest.partition("\n")[2], ",", read.data.shape[1]))
    assert read.data.shape == rows.shape, f"{read.data.shape} of {rows.shape}"
    assert said.get("frames") in (None, len(rows)), "another length"
    assert np.isfinite(read.data).all(), "NaN"
    assert (read.data == rows.astype(said.get("dtype", "float64"))).all(), "other samples"


def _check_theirs(content: bytes, rate: float | None, read: Recording) -> None:
    assert np.isfinite(read.data).all(), "NaN"
    lines = content.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n").split("\n")
    if lines[0].startswith(("# {", "#{")):
        return  # one of ours
    rows = [line for line in lines if line.strip() and not line.startswith(COMMENT)]
    separator = next((mark for mark in (";", "\t", ",") if mark in rows[0]), None)
    cells = next(csv.reader([rows[0]], delimiter=separator)) if separator else re.split("[ \t]+", rows[0].strip(" \t"))
    named = not all(NUMBER.fullmatch(cell) for cell in cells)
    assert not named or all(cell.strip().isdecimal() or not NUMBER.fullmatch(cell) for cell in cells), (
        "numbers as names"
    )
    table = np.array(_rows("\n".join(rows[named:]), separator, len(cells)))
    assert read.data.shape == (len(table), 2), f"{read.data.shape} of {table.shape}"
    plain = [cell.partition("[")[0].strip() if named else "" for cell in cells]
    columns = [plain.index(channel) if channel in plain else int(channel) - 1 for channel in ("1", "2")]
    assert (read.data == table[:, columns]).all(), "other samples"
    timed = [n for n, cell in enumerate(cells) if named and seconds_of(cell.partition("[")[0].strip(), "1")]
    period = np.diff(table[:, timed[0]]).mean() if timed else 1 / (rate or np.nan)
    assert abs(read.rate * period - 1) < 2e-3, f"{read.rate} samples/s"


def _ours() -> list[bytes]:
    noise = np.random.default_rng(1).normal(size=(40, 2))
    return [
        _written(noise.astype("float32"), {"rig": "x"}),
        _written(noise, {}),
        b'# {"rate": 44100}\nchannel\n0.5\n-1e-3\n2\n',
    ]


def _written(noise: np.ndarray, provenance: dict[str, str]) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "x.csv"
        recording.write(path, Recording(("a", "b"), ("V", "m/s^2"), 44_100, noise, provenance))
        return path.read_bytes()


def _others() -> list[bytes]:
    noise = np.random.default_rng(1).normal(size=(40, 2)).tolist()
    files = []
    for separator in (",", ";", "\t", " "):
        rows = [separator.join(f"{cell:.5g}" for cell in row) for row in noise]
        timed = [f"{0.01 * n:.6g}{separator}{row}" for n, row in enumerate(rows)]
        files.append("\n".join(rows))
        files.append("\n".join([separator.join(("in[V]", "out[m]")), *rows, ""]))
        files.append("\r\n".join([separator.join(("time", "in", "out")), *timed]))
    return [file.encode() for file in files]
