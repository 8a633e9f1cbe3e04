"""Files of others block by block: the same samples as whole, in memory for a block or two, faults by place."""

import tracemalloc
from pathlib import Path

import h5py
import numpy as np
import pytest
import soundfile

from ctlblocks import recording
from ctlblocks.recording import Recording, RecordingError
from rigkit import table_rows
from rigkit.foreign_record import open_signals, read_signals

RATE = 1_000.0
DATA = np.random.default_rng(1).normal(size=(5_000, 3)) / 10


def _wav(path: Path, data: np.ndarray) -> None:
    soundfile.write(path, data, int(RATE), "DOUBLE")


def _rf64(path: Path, data: np.ndarray) -> None:
    soundfile.write(path, data, int(RATE), "DOUBLE", format="RF64")


def _csv(path: Path, data: np.ndarray) -> None:
    np.savetxt(path, np.column_stack([np.arange(len(data)) / RATE, data]), "%.17g", ",", header="t,a,b,c", comments="")


def _own(path: Path, data: np.ndarray) -> None:
    recording.write(path, Recording(("a", "b", "c"), ("V", "V", "m"), RATE, data))


def _hdf5(path: Path, data: np.ndarray) -> None:
    with h5py.File(path, "w") as file:
        file.attrs["rate"] = RATE
        file["x/first"] = data[:, 0]
        file["y"] = data[:, 1:]


KINDS = {"a.wav": _wav, "b.wav": _rf64, "c.csv": _csv, "d.csv": _own, "e.wav": _own, "f.h5": _hdf5}


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("size", [1, 999, 5_000, 8_000])
def test_blocks_are_what_the_whole_is(tmp_path: Path, name: str, size: int) -> None:
    KINDS[name](tmp_path / name, DATA)
    found = open_signals(tmp_path / name)
    assert (found.rate, found.frames, len(found.names)) == (pytest.approx(RATE), len(DATA), 3)
    blocks = list(found.blocks(size))
    assert [len(block) for block in blocks[:-1]] == [size] * (len(blocks) - 1)
    np.testing.assert_array_equal(np.concatenate(blocks), DATA)
    np.testing.assert_array_equal(found.whole().data, DATA)
    np.testing.assert_array_equal(found.select([found.names[2], "1"]).whole().data, DATA[:, [2, 0]])


@pytest.mark.parametrize("name", KINDS)
def test_memory_does_not_grow_with_the_file(tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(table_rows, "BLOCK", 2**16)
    monkeypatch.setattr("rigkit.foreign_sound.BLOCK", 2**10)
    monkeypatch.setattr("rigkit.foreign_arrays.BLOCK", 2**10)
    long = np.tile(DATA, (12, 1))
    KINDS[name](tmp_path / name, long)
    tracemalloc.start()
    assert sum(len(block) for block in open_signals(tmp_path / name).blocks(1_000)) == len(long)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1e6 < long.nbytes


def test_the_row_is_named_in_a_later_block(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(table_rows, "BLOCK", 1_000)
    path = tmp_path / "a.csv"
    _csv(path, DATA)
    lines = path.read_text().split("\n")
    for row, cells, complaint in (
        (1_234, "1.233,0.1,x,0.2", "row 1235, column 3: 'x', must be a finite number"),
        (1_234, "1.233,0.1", "row 1235 has 2 cells, must have 4"),
        (1_234, "1.232,0.1,0.1,0.1", "row 1235 is 1.232 s, 0 s after row 1234.*the same time again"),
        (1_234, "# a remark\n1.233,0.1,0.1,0.1", None),
    ):
        path.write_text("\n".join([*lines[:row], cells, *lines[row + 1 :]]))
        if complaint is None:
            assert len(read_signals(path).data) == len(DATA)
            continue
        with pytest.raises(RecordingError, match=complaint):
            read_signals(path)
