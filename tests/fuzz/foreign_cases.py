"""Damaged files of others, sounds, tables and arrays, and what each must be read as if it is."""

import itertools
import os
import random
import re
import tempfile
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import IO

import numpy as np
import pytest

from ctlblocks.recording import Recording, RecordingError
from rigkit import array_reader, foreign_arrays
from rigkit.even_time import seconds_of
from rigkit.foreign_record import read_signals
from tests.fuzz.judge import Finding, is_accepted
from tests.fuzz.mutation import Change, mutated, of_bytes, of_text
from tests.fuzz.wav_cases import _check as check_wav
from tests.rigkit.foreign_files import DATA, FORMATS, RATE

SOUNDS = {"wav": ("16.wav", "24.wav", "32.WAV", "float.wav", "double.wav", "own.wav"), "rf64": ("rf64.wav",),
          "flac": ("16.flac", "24.flac")}  # fmt: skip
TABLES = {"csv": ("own.csv", "brackets.csv", "quoted.csv", "mark.csv", "comma.csv", "mac.csv", "remarks.csv"),
          "tsv": ("parentheses.tsv", "units row.txt", "comma.txt"), "lvm": ("one.lvm", "no.lvm")}  # fmt: skip
ARRAYS = {"hdf5": ("a.h5", "timed.hdf5", "73.mat"), "mat": ("4.mat", "5.mat", "7.mat")}
FEW = 60
"""Frames of a file: so that what is changed is often not a sample."""
NUMBER = re.compile(r"\s*\"?[-+]?([0-9]+[.,]?[0-9]*|[.,][0-9]+)([eE][-+]?[0-9]+)?\"?\s*")
SECONDS, MEMORY = 1.0, 2**20
"""s of the processor's time and KiB that the process may take that reads arrays."""


def sound_cases(folder: Path) -> Callable[[int], bool]:
    """Return what reads the damaged sound of a number, and says whether it was accepted."""
    return _cases(folder, SOUNDS, of_bytes, _check_sound)


def table_cases(folder: Path) -> Callable[[int], bool]:
    """Return what reads the damaged table of a number, and says whether it was accepted."""
    return _cases(folder, TABLES, of_text, _check_table)


def array_cases(folder: Path) -> Callable[[int], bool]:
    """Return what reads the damaged file of arrays of a number, and says whether it was accepted.

    The process that reads is forked: to start it anew takes a hundred times as long.
    """
    pytest.MonkeyPatch().setattr(foreign_arrays, "started", _Forked)
    return _cases(folder, ARRAYS, of_bytes, _check_array)


def _cases(
    folder: Path, kinds: dict[str, Sequence[str]], change: Change, check: Callable[[str, bytes, Recording], None]
) -> Callable[[int], bool]:
    sound = {name: _written(name) for name in itertools.chain(*kinds.values())}

    def case(number: int) -> bool:
        chance = random.Random(number)
        name = chance.choice(list(kinds.values())[number % len(kinds)])
        content = mutated(sound[name], chance, list(sound.values()), change)
        path = folder / name
        path.write_bytes(content)
        rate = chance.choice((None, RATE))
        return is_accepted(lambda: read_signals(path, rate), partial(check, name, content), RecordingError)

    return case


def _written(name: str) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        FORMATS[name][0](Path(folder) / name, DATA[:FEW])
        return (Path(folder) / name).read_bytes()


def _check_sound(name: str, content: bytes, read: Recording) -> None:
    if not name.endswith(".flac"):
        check_wav(content, read)
        return
    packed = int.from_bytes(content[18:26], "big")
    said = packed >> 44, (packed & (1 << 36) - 1, (packed >> 41 & 7) + 1)
    assert (read.rate, read.data.shape) == said, f"{read.rate} samples/s, {read.data.shape}, not {said}"
    assert not any(content[26:42]) or np.array_equal(read.data, DATA[:FEW]), "other samples"


def _check_table(name: str, content: bytes, read: Recording) -> None:
    """Look for every column among those of the last rows that hold numbers alone."""
    lines = content.decode("utf-8-sig", "replace").replace("\r\n", "\n").replace("\r", "\n").split("\n")
    first = next(line for line in lines if line.strip() and line[0] not in "#%")
    is_told = name.endswith("lvm") or lines[0].startswith("# {")
    marks = ("\t" if name.endswith("lvm") else ",") if is_told else ";\t,"
    mark = next((mark for mark in marks if is_told or mark in first), "[ \t]+")
    rows = []
    for line in lines:
        cells = re.split(mark, line.strip("\t"))
        cells = cells[: {"one.lvm": 4, "no.lvm": 3}.get(name)]  # and a remark
        if line.strip() and all(NUMBER.fullmatch(cell) for cell in cells):
            rows.append([float(cell.strip(' "').replace(",", ".")) for cell in cells])
    rows = rows[-len(read.data) :]
    assert len({len(row) for row in rows}) == 1, "rows of several lengths"
    assert len(rows) == len(read.data), f"{len(read.data)} samples in {len(rows)} rows"
    there = {column.tobytes() for column in np.array(rows).T}
    assert np.isfinite(read.data).all(), "NaN"
    assert all(column.tobytes() in there for column in read.data.T), "other samples"


def _check_array(_name: str, _: bytes, read: Recording) -> None:
    """Look at rate and length: a number that is another one in the file is another one, and so is time's name."""
    assert 0 < read.rate < np.inf, f"{read.rate} samples/s"
    assert np.isfinite(read.data).all(), "NaN"
    assert len(read.data) == FEW, f"{read.data.shape} for {FEW}"
    renamed = [
        name
        for name, column in zip(read.names, read.data.T, strict=True)
        if np.allclose(np.diff(column), 1 / RATE) and seconds_of(name, "1") is None
    ]
    assert read.data.shape[1] - bool(renamed) <= 3, f"{read.data.shape} for {FEW} of 3"


class _Forked:
    """The process that reads arrays, as `subprocess.Popen` has it: forked, watched for time and memory."""

    def __init__(self, path: Path, channels: Sequence[str] | None) -> None:
        reading, writing = os.pipe()
        self._process, self._status = os.fork(), 0
        if self._process == 0:
            os.close(reading)
            try:
                with open(writing, "wb") as pipe:
                    array_reader.main(path, channels, pipe.write)
            except BaseException:
                os._exit(1)
            os._exit(0)
        os.close(writing)
        self.stdout: IO[bytes] = open(reading, "rb")

    def __enter__(self) -> "_Forked":
        return self

    def __exit__(self, *_: object) -> None:
        self.stdout.close()
        self.wait()

    def kill(self) -> None:
        """Let it end by itself: it has nobody to write to."""
        self.stdout.close()

    def wait(self) -> int:
        """Return how it ended; `Finding` where it took too much."""
        if self._process:
            _, status, used = os.wait4(self._process, 0)
            self._process, self._status = 0, os.waitstatus_to_exitcode(status)
            if used.ru_utime + used.ru_stime > SECONDS or used.ru_maxrss > MEMORY:
                raise Finding(f"{used.ru_utime + used.ru_stime:.1f} s, {used.ru_maxrss} KiB")
        return self._status
