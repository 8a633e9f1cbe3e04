"""Files of others that are damaged or contradict themselves are refused in one line, with file, place and value."""

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.io
import soundfile

from ctlblocks.recording import RecordingError
from rigkit.foreign_record import open_signals, read_channels, read_signals
from tests.rigkit.foreign_files import DATA, FORMATS, TIME

GARBAGE = np.random.default_rng(2).bytes(3_000)


def _timed(time: np.ndarray) -> str:
    return "t,u\n" + "".join(f"{second:.6f},1\n" for second in time)


def _moved(place: int, by: float) -> np.ndarray:
    return np.where(np.arange(len(TIME)) == place, TIME + by, TIME)


TABLES = {
    "empty": ("", "has 0 rows, must have at least 2"),
    "names alone": ("u,y\n", "has 1 rows, must have at least 2"),
    "names and units alone": ("u,y\nV,m\n", "has names and units, but no row of numbers"),
    "ragged": ("t,u\n0,1\n0.1,2,3\n0.2,1\n", "row 3 has 3 cells, must have 2"),
    "too short": ("t;u\n0;1\n0.1\n", "row 3 has 1 cells, must have 2"),
    "text": ("t,u\n0,1\n0.1,one\n", "row 3, column 2: 'one', must be a finite number"),
    "nothing": ("t,u\n0,1\n0.1,\n", "row 3, column 2: '', must be a finite number"),
    "nan": ("t,u\n0,1\n0.1,NaN\n", "row 3, column 2: 'NaN', must be a finite number"),
    "overflow": ("t,u\n0,1\n0.1,1e999\n", "row 3, column 2: '1e999', must be a finite number"),
    "thousands": ("t;u\n0;1.5\n0.1;1.000,5\n", "row 3, column 2: '1.000,5', must be a finite number"),
    "both marks": ("t;u\n0;1,5\n0.1;1.5\n", "row 3, column 1: '0.1', must be a finite number"),
    "a row of units that is none": ("t,u\ns,1\n0,1\n", "row 2, column 1: 's', must be a finite number"),
    "numbers for names": ("0.1,u\n0,1\n", "row 1 is '0.1,u', must be names, or numbers"),
    "two of a name": ("t,u,u\n0,1,2\n1,1,2\n", "must all be different"),
    "no name": ("t,,u\n0,1,2\n1,1,2\n", "must be 3 printable texts"),
    "time alone": ("t\n0\n1\n", "holds nothing but t"),
    "one time": ("t,u\n0,1\n", "'t': has 1 row, must have at least 2 to tell the rate"),
    "time of another kind": ("t [m],u\n0,1\n1,1\n", "'t' is in m, must be in s, ms, us or ns"),
    "duplicate": (_timed(np.insert(TIME, 7, TIME[6])), r"row 9 is 0.006 s, 0 s after row 8.*\(the same time again\)"),
    "backward": (_timed(_moved(200, -0.05)), r"row 202 is 0.15 s, -0.049 s after row 201.*\(time goes back\)"),
    "all backward": (_timed(TIME[::-1]), r"row 3 is 0.398 s, -0.001 s after row 2.*\(time goes back\)"),
    "jitter": (_timed(_moved(200, 0.0007)), r"row 202 is 0.2007 s, 0.0017 s after row 201, most steps are 0.001 s"),
    "gap": (_timed(np.delete(TIME, 50)), r"row 52 is 0.051 s, 0.002 s after row 51.*\(samples are missing\)"),
    "long gap": (_timed(TIME + 3600 * (TIME > 0.3)), r"row 303 is 3600.301 s, 3600 s after row 302.*are missing"),
    "two rates": ('# {"rate": 500}\nt,u\n' + _timed(TIME)[4:], "says 500 samples/s, its column 't' 1000"),
    "cut off": ('# {"rate": 500, "frames": 2}\nu\n0.1\n0.2', "the last row has no end of a line"),
    "too few": ('# {"rate": 500, "frames": 3}\nu\n0.1\n0.2\n', "has 2 samples, must have 3"),
    "another program's remark": ("# {by a logger}\nu\n0.1\n", r"row 1: '# \{by a logger\}', must be as # "),
    "a long line": ("t,u\n0,1\n" + "1" * 2**22, "row 3 is no row of a table: more than 1048576 bytes"),
}


@pytest.mark.parametrize("what", TABLES)
def test_a_table_is_refused_with_row_and_cell(tmp_path: Path, what: str) -> None:
    text, complaint = TABLES[what]
    _refuses(tmp_path / "a.csv", text.encode(), complaint)


def _wav(path: Path, data: np.ndarray = DATA) -> bytes:
    soundfile.write(path, data, 1_000, "DOUBLE")
    return path.read_bytes()


def _flac(path: Path) -> bytes:
    soundfile.write(path, DATA, 1_000, "PCM_16", format="FLAC")
    return path.read_bytes()


def _put(content: bytes, place: int, piece: bytes) -> bytes:
    return content[:place] + piece + content[place + len(piece) :]


SOUNDS: dict[str, tuple[str, Callable[[Path], bytes], str]] = {
    "empty": ("a.wav", lambda _: b"", "not a WAV file, or its header is cut off"),
    "no samples": ("a.wav", lambda path: _wav(path, DATA[:0]), "the WAV has no samples"),
    "cut off": ("a.wav", lambda path: _wav(path)[:-100], "the header says 9696 bytes, the file has 9596"),
    "rate": ("a.wav", lambda path: _put(_wav(path), 24, b"\x01"), "the header does not add up"),
    "nan": ("a.wav", lambda path: _wav(path, np.where(DATA == DATA[30, 1], np.nan, DATA)),
            r"channel 'channel_2', sample 30: nan, must be finite \(at 0.03 s\)"),
    "text": ("a.wav", lambda _: b"t,u\n0,1\n" * 9, "not a WAV file"),
    "another sound": ("a.wav", _flac, "not a WAV file"),
    "no FLAC": ("a.flac", lambda _: GARBAGE, "not a FLAC file, or its head is cut off"),
    "FLAC cut off": ("a.flac", lambda path: _flac(path)[:-200], "a.flac: "),
    "FLAC's rate": ("a.flac", lambda path: _put(_flac(path), 18, b"\x01"),
                    "the head says 5096 samples/s, 3 channels, 16 bits, the first frame 1000, 3, 16"),
    "FLAC's length": ("a.flac", lambda path: _put(_flac(path), 25, b"\x91"), "is damaged behind sample 0 "),
    "FLAC's samples": ("a.flac", lambda path: _put(_flac(path), 26, b"other checksums."), "their checksum is another"),
}  # fmt: skip


@pytest.mark.parametrize("what", SOUNDS)
def test_a_sound_is_refused_with_its_second(tmp_path: Path, what: str) -> None:
    name, content, complaint = SOUNDS[what]
    _refuses(tmp_path / name, content(tmp_path / name), complaint)


def _array(path: Path, **content: object) -> bytes:
    scipy.io.savemat(path, content)
    return path.read_bytes()


def _renamed(path: Path) -> bytes:
    """Damage the byte that ends a variable's name."""
    scipy.io.savemat(path, {"t": TIME[:, None]}, format="4")
    return path.read_bytes().replace(b"t\0", b"t\xc4", 1)


def _nan(path: Path) -> bytes:
    return _array(path, u=np.where(np.arange(400) == 30, np.nan, 0.0), fs=100.0)


def _huge(path: Path) -> bytes:
    with h5py.File(path, "w") as file:
        file.create_dataset("u", shape=(2**40,), chunks=(1000,), dtype=float)
        file.attrs["fs"] = 1.0
    return path.read_bytes()


def _half(path: Path) -> bytes:
    with h5py.File(path, "w") as file:
        file.create_dataset("u", shape=(400,), chunks=(100,), dtype=float)[:150] = 1.0
        file.attrs["fs"] = 1.0
    return path.read_bytes()


ARRAYS: dict[str, tuple[str, Callable[[Path], bytes], str]] = {
    "no numbers": ("a.mat", lambda path: _array(path, note="words", z=np.array([1j, 2])),
                   r"no arrays of real numbers, but note \(1 x 1 char\), z \(1 x 2 double\)|holds no signals"),
    "a name": ("a.mat", _renamed, "is damaged: a variable is called 't\xc4', must be letters"),
    "two lengths": ("a.mat", lambda path: _array(path, u=TIME, y=TIME[:7], fs=1.0), "different lengths, u 400, y 7"),
    "turned": ("a.mat", lambda path: _array(path, y=DATA.T, fs=1.0), "y is 3 x 400, must have time along its first"),
    "two rates": ("a.mat", lambda path: _array(path, u=TIME, t=TIME, Fs=900.0),
                  "says several rates, 900 by 'Fs', 1000 by 't' samples/s: they must agree"),
    "no rate": ("a.mat", lambda path: _array(path, u=TIME), "does not say its rate"),
    "zero rate": ("a.mat", lambda path: _array(path, u=TIME, dt=0.0), "its dt is 0, must be finite and > 0"),
    "gap": ("a.mat", lambda path: _array(path, u=TIME[1:], t=np.delete(TIME, 50)),
            r"'t' does not rise in even steps.*sample 50 is 0.051 s, 0.002 s after sample 49.*missing"),
    "nan": ("a.mat", _nan, r"channel 'u', sample 30: nan, must be finite \(at 0.3 s\)"),
    "garbage": ("a.mat", lambda _: GARBAGE, "is no MAT file, or a damaged one"),
    "cut off": ("a.mat", lambda path: _array(path, u=TIME, fs=1.0)[:-900], "a.mat: "),
    "HDF5 garbage": ("a.h5", lambda _: GARBAGE, "is no HDF5 file, or a damaged one"),
    "half written": ("a.h5", _half, "u is not whole: 2 chunks are stored, must be 4"),
    "more than is there": ("a.h5", _huge, "u has 8796093022208 bytes, in a file of"),
}  # fmt: skip


@pytest.mark.sample(6)
@pytest.mark.parametrize("what", ARRAYS)
def test_arrays_are_refused_with_name_and_sample(tmp_path: Path, what: str) -> None:
    name, content, complaint = ARRAYS[what]
    _refuses(tmp_path / name, content(tmp_path / name), complaint)


def test_what_is_no_file_of_signals_is_refused(tmp_path: Path) -> None:
    _refuses(tmp_path / "a.csv", GARBAGE, r"a.csv: byte 0x.. in line \d+ is not UTF-8")
    _refuses(tmp_path / "a.docx", b"t,u\n0,1\n1,1\n", "suffix is '.docx', must be one of .wav, .flac, .csv, .*.mat")
    _refuses(tmp_path / "a", b"t,u\n0,1\n1,1\n", "suffix is '', must be one of")
    with pytest.raises(RecordingError, match="is a folder, must be a file"):
        read_signals(tmp_path)


@pytest.mark.parametrize("name", ["double.wav", "brackets.csv", "one.lvm", "5.mat"])
def test_another_rate_than_the_files_is_refused(tmp_path: Path, name: str) -> None:
    FORMATS[name][0](tmp_path / name, DATA)
    with pytest.raises(RecordingError, match="1000 samples/s, must be 900"):
        open_signals(tmp_path / name, 900.0)
    with pytest.raises(RecordingError, match="1000 samples/s, --rate says 900"):
        read_channels(tmp_path / name, ["1"], 900.0)


def test_a_rounded_period_of_labview_gives_way_to_the_rate_that_is_given(tmp_path: Path) -> None:
    path = tmp_path / "no.lvm"
    FORMATS[path.name][0](path, DATA)
    path.write_text(path.read_text().replace("0,001000", "0,000023"))
    assert open_signals(path).rate == pytest.approx(43_478.26)
    assert open_signals(path, 44_100.0).rate == 44_100.0
    with pytest.raises(RecordingError, match="43478.2609 samples/s, must be 48000"):
        open_signals(path, 48_000.0)


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("X_Columns\tOne", "X_Columns\tMulti", "X_Columns is Multi"),
        ("Decimal_Separator\t.", "Decimal_Separator\tx", "Decimal_Separator is 'x'"),
        ("0.001000\t0.001000\t0", "0.001000\t0.002000\t0", "Delta_X is 0.001000, 0.002000, must be one period in s"),
        ("0.001000\t0.001000\t0.001000", "0.004\t0.004\t0.004", "Delta_X says 250 samples/s, X_Value 1000"),
        ("***End_of_Header***\t\t", "", r"\*\*\*End_of_Header\*\*\* comes 1 times in 200 rows"),
    ],
)
def test_a_head_of_labview_is_refused_by_its_tag(tmp_path: Path, old: str, new: str, complaint: str) -> None:
    path = tmp_path / "one.lvm"
    FORMATS[path.name][0](path, DATA)
    content = path.read_text()
    assert old in content
    _refuses(path, content.replace(old, new).encode(), complaint)


def test_a_segment_more_of_labview_is_refused_by_its_row(tmp_path: Path) -> None:
    path = tmp_path / "one.lvm"
    FORMATS[path.name][0](path, DATA)
    _refuses(path, path.read_bytes() + b"\r\nChannels\t3\t\t\r\n", "row 425 has 2 cells, must have 4")


def test_a_library_that_dies_is_a_damaged_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.h5"
    FORMATS[path.name][0](path, DATA)
    monkeypatch.setattr("rigkit.foreign_arrays.READER", "rigkit.no_such_reader")
    with pytest.raises(RecordingError, match=r"a\.h5: its library fails on it \(1\), it is damaged or too large"):
        open_signals(path)


def _refuses(path: Path, content: bytes, complaint: str) -> None:
    path.write_bytes(content)
    with pytest.raises(RecordingError, match=complaint) as refusal:
        read_signals(path)
    assert str(refusal.value).startswith(f"{path}: ")
    assert "\n" not in str(refusal.value)
