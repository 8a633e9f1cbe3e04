"""Files of others: channels by name and number, rates from wherever they are said, faults by name in one line."""

from pathlib import Path

import h5py
import numpy as np
import pytest

from ctlblocks import recording
from ctlblocks.recording import Recording, RecordingError
from rigkit.foreign_record import read_channels

DATA = np.arange(12.0).reshape(6, 2)


@pytest.mark.parametrize("between", [",", ";", "\t", " "])
def test_a_table_with_names_is_read_by_name_and_by_number(tmp_path: Path, between: str) -> None:
    path = tmp_path / "data.csv"
    rows = [between.join(["force[N]", "y"])] + [between.join(map(str, row)) for row in DATA]
    path.write_text("\n".join(rows) + "\n")
    found = read_channels(path, ["y", "1"], 100.0)
    assert found.names == ("y", "force")
    assert found.units == ("1", "N")
    np.testing.assert_array_equal(found.data, DATA[:, ::-1])


def test_a_table_without_names_is_read_by_number(tmp_path: Path) -> None:
    path = tmp_path / "data.txt"
    np.savetxt(path, DATA)
    np.testing.assert_array_equal(read_channels(path, ["2"], 10.0).data, DATA[:, 1:])


def test_a_column_of_time_gives_the_rate(tmp_path: Path) -> None:
    path = tmp_path / "data.csv"
    rows = [f"{0.004 * k:.3f},{k}" for k in range(50)]
    path.write_text("Time [s],u\n" + "\n".join(rows))
    assert read_channels(path, ["u"], None).rate == pytest.approx(250.0)
    with pytest.raises(RecordingError, match="--rate says 300"):
        read_channels(path, ["u"], 300.0)
    path.write_text("t,u\n" + "\n".join(rows[:20] + rows[21:]))
    with pytest.raises(RecordingError, match="does not rise in even steps"):
        read_channels(path, ["u"], None)


@pytest.mark.parametrize("suffix", [".csv", ".wav"])
def test_recordings_of_this_program_say_everything_themselves(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"data{suffix}"
    recording.write(path, Recording(("u", "y"), ("V", "m"), 100.0, DATA))
    found = read_channels(path, ["y"], None)
    assert (found.names, found.units, found.rate) == (("y",), ("m",), 100.0)


def test_datasets_are_read_by_path_and_column(tmp_path: Path) -> None:
    path = tmp_path / "data.h5"
    with h5py.File(path, "w") as file:
        file["run/u"] = DATA[:, 0]
        file["run/y"] = DATA
        file["run/y"].attrs["unit"] = "m"
        file.attrs["rate"] = 50.0
        file["short"] = DATA[:3, 0]
        file["none"] = DATA[:0]
    found = read_channels(path, ["run/u", "run/y:2"], None)
    assert (found.names, found.units, found.rate) == (("run/u", "run/y:2"), ("1", "m"), 50.0)
    np.testing.assert_array_equal(found.data, DATA)
    for channels, complaint in (
        (["run/y"], "must name one of 2 columns"),
        (["run/z"], "no dataset 'run/z'.*run/u"),
        (["run/u", "short"], "different lengths"),
        (["none:1", "none:2"], "frames >= 1"),
    ):
        with pytest.raises(RecordingError, match=complaint):
            read_channels(path, channels, None)


def test_a_rate_that_is_no_number_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "data.h5"
    with h5py.File(path, "w") as file:
        file["u"] = DATA[:, 0]
        file.attrs["rate"] = "fast"
    with pytest.raises(RecordingError, match="its rate is 'fast'"):
        read_channels(path, ["u"], None)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("u,y\n1,2\n3\n", "row 3 has 1 cells, must have 2"),
        ("u,y\n1,2\n3,x\n", "row 3, column 2: 'x', must be a finite number"),
        ("u,y\n1,nan\n", "row 2, column 2: 'nan', must be a finite number"),
        ("u,y\n", "has 1 rows"),
        ("u,u\n1,2\n", "must all be different"),
        ("u,y\n1,2\n", "no channel 'z'; there are u, y, or the numbers 1 to 2"),
    ],
)
def test_a_fault_is_named_with_its_place(tmp_path: Path, text: str, complaint: str) -> None:
    path = tmp_path / "data.csv"
    path.write_text(text)
    with pytest.raises(RecordingError, match=complaint):
        read_channels(path, ["z"] if "no channel" in complaint else ["u"], 10.0)


def test_what_is_no_such_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="no such file"):
        read_channels(tmp_path / "none.csv", ["1"], 1.0)
    for name, complaint in (
        ("a.h5", "is no HDF5 file"),
        ("a.csv", "byte 0xff in line 1 is not UTF-8"),
        ("a.xyz", "suffix is"),
        ("a.wav", "not a WAV file"),
    ):
        (tmp_path / name).write_bytes(b"\xff\xfe\x00 rubbish \x00" * 9)
        with pytest.raises(RecordingError, match=complaint):
            read_channels(tmp_path / name, ["1"], 1.0)


def test_a_rate_that_nobody_says_is_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "data.csv"
    path.write_text("u,y\n1,2\n3,4\n")
    with pytest.raises(RecordingError, match="does not say its rate"):
        read_channels(path, ["u"], None)


def test_cells_that_are_empty_or_nan_are_samples_that_are_missing_where_some_may_be(tmp_path: Path) -> None:
    path = tmp_path / "holes.csv"
    path.write_text("t [s],a,b\n0,1,2\n0.1,,4\n0.2,nan,6\n0.3,7,\n")
    found = read_channels(path, ["a", "b"], None, may_miss=True)
    np.testing.assert_array_equal(found.data, [[1, 2], [np.nan, 4], [np.nan, 6], [7, np.nan]])
    with pytest.raises(RecordingError, match="row 3, column 2: '', must be a finite number"):
        read_channels(path, ["a", "b"], None)


def test_a_row_of_nothing_but_tabs_is_one_that_is_missing(tmp_path: Path) -> None:
    path = tmp_path / "holes.tsv"
    path.write_text("a\tb\n1\t2\n\t\n\n5\t6\n")
    found = read_channels(path, ["a", "b"], 10.0, may_miss=True)
    np.testing.assert_array_equal(found.data, [[1, 2], [np.nan, np.nan], [5, 6]])


@pytest.mark.parametrize(("row", "complaint"), [("0.1,inf,4", "column 2: 'inf'"), (",1,4", "column 1: ''")])
def test_what_is_infinite_and_time_are_refused_all_the_same(tmp_path: Path, row: str, complaint: str) -> None:
    path = tmp_path / "holes.csv"
    path.write_text(f"t [s],a,b\n0,1,2\n{row}\n0.2,5,6\n0.3,7,8\n")
    with pytest.raises(RecordingError, match=complaint):
        read_channels(path, ["a", "b"], None, may_miss=True)
