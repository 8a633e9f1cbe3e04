"""Files of others block by block: the same samples as whole, in memory for a block or two, faults by place."""

import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from ctlblocks.recording import RecordingError
from rigkit import foreign_stream, table_rows
from rigkit.foreign_record import open_signals, read_channels, read_signals
from tests.rigkit.foreign_files import DATA, FORMATS, RATE
from tests.shared_data import shared

STREAMED = ("double.wav", "rf64.wav", "24.flac", "own.csv", "brackets.csv", "one.lvm", "a.h5", "73.mat")
"""Kinds that are never in memory as a whole; MATLAB's up to version 7 are, in a process of their own."""


@pytest.mark.sample(8)
@pytest.mark.parametrize("name", FORMATS)
def test_names_units_rate_and_samples_are_read(tmp_path: Path, name: str) -> None:
    write, (names, units) = FORMATS[name]
    write(tmp_path / name, DATA)
    found = open_signals(tmp_path / name)
    assert (found.names, found.units, found.rate) == (names, units, pytest.approx(RATE, rel=1e-9))
    np.testing.assert_array_equal(found.whole().data, DATA)
    np.testing.assert_array_equal(read_channels(tmp_path / name, [names[2], names[0]], RATE).data, DATA[:, [2, 0]])


@pytest.mark.parametrize("name", STREAMED)
def test_blocks_are_what_the_whole_is(tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(table_rows, "BLOCK", 1_000)
    monkeypatch.setattr(foreign_stream, "VALUES", 210)
    path = tmp_path / name
    FORMATS[name][0](path, DATA)
    found = open_signals(path, RATE)
    for size in (70, 500) if path.suffix in (".h5", ".mat") else (1, 70, 399, 400, 500):
        blocks = list(found.blocks(size))
        assert [len(block) for block in blocks[:-1]] == [size] * (len(blocks) - 1)
        np.testing.assert_array_equal(np.concatenate(blocks), DATA)
    np.testing.assert_array_equal(found.whole().data, DATA)
    np.testing.assert_array_equal(found.select([found.names[2], "1"]).whole().data, DATA[:, [2, 0]])


@pytest.mark.parametrize("name", STREAMED)
def test_memory_does_not_grow_with_the_file(tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(table_rows, "BLOCK", 2**15)
    monkeypatch.setattr(foreign_stream, "VALUES", 2**12)
    long = np.tile(DATA, (60, 1))
    FORMATS[name][0](tmp_path / name, long)
    tracemalloc.start()
    assert sum(len(block) for block in open_signals(tmp_path / name).blocks(1_000)) == len(long)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < long.nbytes - 10_000, f"{peak} of {long.nbytes} bytes"


def test_the_row_is_named_in_a_later_block(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(table_rows, "BLOCK", 1_000)
    path = tmp_path / "brackets.csv"
    FORMATS[path.name][0](path, DATA)
    lines = path.read_text().split("\n")
    for cells, complaint in (
        ("0.233,0.1,x,0.2", "row 235, column 3: 'x', must be a finite number"),
        ("0.233,0.1", "row 235 has 2 cells, must have 4"),
        ("0.232,0.1,0.1,0.1", "row 235 is 0.232 s, 0 s after row 234.*the same time again"),
        ("# a remark\n0.233,0.1,0.1,0.1", None),
    ):
        path.write_text("\n".join([*lines[:234], cells, *lines[235:]]))
        if complaint is None:
            assert len(read_signals(path).data) == len(DATA)
            continue
        with pytest.raises(RecordingError, match=complaint):
            read_signals(path)


@pytest.mark.parametrize(
    ("text", "rate"),
    [
        ("t_ms,u\n" + "".join(f"{n},{n}\n" for n in range(50)), 1e3),
        ("time [us];u\n" + "".join(f"{n / 3 * 1e3:.0f};{n}\n" for n in range(50)), 3e3),
        ("timestamp,u\n" + "".join(f"{1.7e9 + n / 3e3:.6f},{n}\n" for n in range(50)), 3e3),
        ("seconds,u\n" + "".join(f"{n / 44_100:.6f},{n}\n" for n in range(50)), 44_100),
    ],
)
def test_time_may_have_a_unit_and_be_rounded(tmp_path: Path, text: str, rate: float) -> None:
    (tmp_path / "a.csv").write_text(text)
    assert read_signals(tmp_path / "a.csv").rate == pytest.approx(rate, rel=1e-3)
    assert read_signals(tmp_path / "a.csv", rate).rate == pytest.approx(rate, rel=1e-3)


def test_measurements_of_others_are_read() -> None:
    arm = read_signals(shared("daisy/CD_player_arm_dat.mat"), 2048.0)
    assert (arm.names[0], arm.data.shape) == ("CD_player_arm_dat_1", (2048, 4))
    assert read_channels(shared("daisy_more/winding.mat"), ["winding:7", "1"], 10.0).names == ("winding:7", "winding_1")
    assert open_signals(shared("silverbox/SNLS80mV.csv"), 610.35).whole().data.shape[1] == 2
    assert open_signals(shared("piezo/Model_Vi_Do.dat"), 200.0).whole().data.shape[1] == 7
    assert open_signals(shared("kemar/H0e030a.wav")).rate == 44_100
