"""CSV files: how they look, what people may write by hand, and which cell is refused."""

from pathlib import Path

import numpy as np
import pytest

from ctlblocks.recording import Recording, RecordingError, read, write

HEAD = '# {"rate": 1000}\n'


def test_a_file_looks_as_documented(tmp_path: Path) -> None:
    data = np.array([[0.1, -2.0], [1e-30, 3.0]])
    write(tmp_path / "x.csv", Recording(("left", "a, b"), ("m/s^2", "1"), 250.5, data, {"rig": "å"}))
    assert (tmp_path / "x.csv").read_text() == (
        '# {"rate": 250.5, "frames": 2, "dtype": "float64", "provenance": {"rig": "\\u00e5"}}\n'
        'left [m/s^2],"a, b [1]"\n0.1,-2.0\n1e-30,3.0\n'
    )


def test_a_file_written_by_hand_needs_a_rate_and_names(tmp_path: Path) -> None:
    path = tmp_path / "x.csv"
    path.write_bytes(b'\xef\xbb\xbf# {"rate": 1000}\r\nleft [m/s^2], right\r\n1, 2.5\r\n-3e-2,4')
    found = read(path)
    assert (found.names, found.units, found.rate) == (("left", "right"), ("m/s^2", "1"), 1000.0)
    assert found.data.tolist() == [[1.0, 2.5], [-0.03, 4.0]]
    assert found.data.dtype == np.float64


@pytest.mark.parametrize(
    "first",
    [
        "time,left\n",
        "# 1000\n",
        "#\n",
        "# {}\n",
        '# {"frames": 2}\n',
        '# {"rate": 1000\n',
        '# {"rate": 1000, "units": "V"}\n',
        "# " + "[" * 100_000 + "\n",
    ],
)
def test_a_first_row_without_a_rate_is_refused_with_an_example(tmp_path: Path, first: str) -> None:
    path = tmp_path / "x.csv"
    path.write_text(first + "a,b\n1,2\n")
    with pytest.raises(RecordingError, match=r'x.csv: row 1: .*, must be as # \{"rate": 44100\}, with rate, frames,'):
        read(path)


@pytest.mark.parametrize(
    ("first", "message"),
    [
        ('{"rate": "fast"}', "rate is 'fast' samples/s"),
        ('{"rate": null}', "rate is None samples/s"),
        ('{"rate": -1}', "rate is -1 samples/s"),
        ('{"rate": Infinity}', "rate is inf samples/s"),
        ('{"rate": 1' + "0" * 400 + "}", "int too large"),
        ('{"rate": 1, "dtype": "int8"}', "data is int8"),
        ('{"rate": 1, "dtype": "number"}', "data type 'number' not understood"),
        ('{"rate": 1, "dtype": [1]}', ""),
        ('{"rate": 1, "provenance": 3}', "int"),
        ('{"rate": 1, "frames": 3}', "row 1 says 3 samples, there are 2"),
    ],
)
def test_a_first_row_that_says_something_impossible_is_refused(tmp_path: Path, first: str, message: str) -> None:
    path = tmp_path / "x.csv"
    path.write_text(f"# {first}\na,b\n1,2\n3,4\n")
    with pytest.raises(RecordingError, match=rf"x.csv: .*{message}"):
        read(path)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("1,2\n3,four\n", r"row 4, column 2: 'four\\n', must be a number"),
        ("1,\n", "row 3, column 2: .*, must be a number"),
        (",2\n", "row 3, column 1: '', must be a number"),
        ("1,2\n3\n", r"row 4: '3\\n', must be 2 numbers"),
        ("1,2,3\n", r"row 3: '1,2,3\\n', must be 2 numbers"),
        ("1,2\n\n3,4\n", "row 4, column 1: .*, must be a number"),
        ("1,2_0\n", r"row 3: '1,2_0\\n', must be 2 numbers"),
        ("1;2\n", "row 3, column 1: .*, must be a number"),
        ("0,5;0,7\n", "row 3, column 2: '5;0', must be a number"),
        ("1,2\n3,nan\n", "channel 'b', sample 1: nan, must be finite"),
        ("1,2\ninf,4\n", "channel 'a', sample 1: inf, must be finite"),
        ("1,1e999\n", "channel 'b', sample 0: inf, must be finite"),
        ("", r"data is float64 \(0, 2\), must be"),
    ],
)
def test_a_bad_cell_is_refused_with_row_column_and_text(tmp_path: Path, rows: str, message: str) -> None:
    path = tmp_path / "x.csv"
    path.write_text(f"{HEAD}a,b\n{rows}")
    with pytest.raises(RecordingError, match=rf"x.csv: {message}"):
        read(path)


def test_a_number_beyond_float32_is_refused_where_the_file_says_float32(tmp_path: Path) -> None:
    path = tmp_path / "x.csv"
    path.write_text('# {"rate": 1, "dtype": "float32"}\na\n1e39\n')
    with pytest.raises(RecordingError, match="channel 'a', sample 0: inf, must be finite"):
        read(path)


@pytest.mark.parametrize(("names", "message"), [("a,a", "names are a, a, must all be different"), ("a,", "names are")])
def test_names_that_cannot_be_told_apart_are_refused(tmp_path: Path, names: str, message: str) -> None:
    path = tmp_path / "x.csv"
    path.write_text(f"{HEAD}{names}\n1,2\n")
    with pytest.raises(RecordingError, match=rf"x.csv: {message}"):
        read(path)


@pytest.mark.parametrize("content", [b"\xff\xfe\x00", b'# {"rate": 1}\na\n\xff\n', b"\x00" * 50])
def test_what_is_not_text_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "x.csv"
    path.write_bytes(content)
    with pytest.raises(RecordingError, match=r"x.csv: "):
        read(path)
