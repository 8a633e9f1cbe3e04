"""Recordings, and their files as a whole: round trips, refusals, atomic writes.  Formats have tests of their own."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from ctlblocks import wav_file
from ctlblocks.recording import Recording, RecordingError, read, write

NOISE = np.random.default_rng(2).standard_normal((50, 2))


def recording(dtype: str = "float32", **changed: object) -> Recording:
    fields: dict[str, object] = {
        "names": ("drive_1", "acceleration, left"),
        "units": ("V", "m/s^2"),
        "rate": 44_100.0,
        "data": NOISE.astype(dtype),
        "provenance": {"rig": "bench å", "comment": 'say "hello",\nthen go'},
    }
    return Recording(**(fields | changed))  # type: ignore[arg-type]


def same(one: Recording, other: Recording) -> bool:
    return (one.names, one.units, one.rate, one.provenance, one.data.dtype) == (
        other.names,
        other.units,
        other.rate,
        other.provenance,
        other.data.dtype,
    ) and one.data.tobytes() == other.data.tobytes()


# in memory


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"data": np.zeros((3, 2), int)}, r"data is int64 \(3, 2\), must be float32 or float64"),
        ({"data": np.zeros((3, 2), ">f4")}, r"data is >f4 \(3, 2\), must be float32 or float64"),
        ({"data": np.zeros(3)}, r"data is float64 \(3,\), must be"),
        ({"data": np.zeros((0, 2))}, r"data is float64 \(0, 2\), must be .* \(frames >= 1, channels >= 1\)"),
        ({"names": ("a",)}, r"names are \('a',\), must be 2 printable"),
        ({"names": ("a", "")}, "names are .*, must be 2 printable"),
        ({"names": ("a", " b")}, "names are .*, must be 2 printable"),
        ({"names": ("a", "b [V]")}, "names are .*, must be 2 printable texts without brackets"),
        ({"names": ("a", "b\n")}, "names are .*, must be 2 printable"),
        ({"names": ("a", 3)}, "names are .*, must be 2 printable"),
        ({"names": ("a", "a")}, "names are a, a, must all be different"),
        ({"units": ("V", "")}, "units are .*, must be 2 printable"),
        ({"rate": 0.0}, "rate is 0.0 samples/s, must be finite and > 0"),
        ({"rate": float("nan")}, "rate is nan samples/s"),
        ({"rate": float("inf")}, "rate is inf samples/s"),
        ({"rate": "fast"}, "rate is 'fast' samples/s"),
        ({"provenance": {"shot": 3}}, r"provenance is \{'shot': 3\}, must map text to text"),
    ],
)
def test_what_could_not_be_written_and_read_back_is_refused_with_its_value(
    changed: dict[str, object], message: str
) -> None:
    with pytest.raises(RecordingError, match=message):
        recording(**changed)


def test_a_recording_cannot_be_changed_through_itself() -> None:
    provenance = {"rig": "bench"}
    fixed = recording(provenance=provenance)
    provenance["rig"] = "other"
    assert fixed.provenance == {"rig": "bench"}
    with pytest.raises(ValueError, match="read-only"):
        fixed.data[0, 0] = 1.0


def test_channels_are_selected_by_name_in_the_order_asked_for() -> None:
    chosen = recording().select(["acceleration, left", "drive_1"])
    assert chosen.names == ("acceleration, left", "drive_1")
    assert chosen.units == ("m/s^2", "V")
    assert np.array_equal(chosen.data, NOISE.astype("float32")[:, ::-1])
    with pytest.raises(RecordingError, match="no channel 'force'; there are drive_1, acceleration, left"):
        recording().select(["force"])


# written and read


@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("suffix", [".wav", ".WAV", ".csv"])
def test_everything_comes_back_bit_for_bit(tmp_path: Path, suffix: str, dtype: str) -> None:
    written = recording(dtype)
    write(tmp_path / f"shot{suffix}", written)
    assert same(read(str(tmp_path / f"shot{suffix}")), written)


@pytest.mark.parametrize("suffix", [".wav", ".csv"])
@pytest.mark.parametrize(("dtype", "width"), [("float32", 32), ("float64", 64)])
def test_any_finite_number_comes_back_bit_for_bit(tmp_path: Path, suffix: str, dtype: str, width: int) -> None:
    numbers = st.floats(width=width, allow_nan=False, allow_infinity=False)  # type: ignore[call-overload]
    path = tmp_path / f"any{suffix}"

    @settings(max_examples=60, deadline=None, derandomize=True)
    @given(arrays(dtype, st.tuples(st.integers(1, 20), st.just(2)), elements=numbers))
    def check(data: np.ndarray) -> None:
        write(path, recording(data=data))
        assert read(path).data.tobytes() == data.tobytes()

    check()


def test_a_view_with_gaps_is_written_as_it_is(tmp_path: Path) -> None:
    sparse = recording(data=NOISE.repeat(2, axis=0).repeat(2, axis=1)[::2, ::2])
    for suffix in (".wav", ".csv"):
        write(tmp_path / f"view{suffix}", sparse)
        assert np.array_equal(read(tmp_path / f"view{suffix}").data, NOISE)


@pytest.mark.parametrize("suffix", [".wav", ".csv"])
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_sample_that_is_not_finite_is_kept_by_write_and_refused_by_read(
    tmp_path: Path, suffix: str, bad: float
) -> None:
    data = NOISE.copy()
    data[30, 0] = data[7, 1] = bad
    write(tmp_path / f"bad{suffix}", recording(data=data))
    with pytest.raises(RecordingError, match=rf"bad{suffix}: channel 'acceleration, left', sample 7: {bad}, must be"):
        read(tmp_path / f"bad{suffix}")


@pytest.mark.parametrize("suffix", [".wav", ".csv"])
@pytest.mark.parametrize(
    ("expected", "message"),
    [
        ({"rate": 48_000.0}, "44100 samples/s, must be 48000"),
        ({"channels": 1}, "2 channels, must be 1"),
        ({"names": ["drive_1"]}, "drive_1, acceleration, left as names, must be drive_1"),
    ],
)
def test_what_is_not_expected_is_refused_in_one_line(
    tmp_path: Path, suffix: str, expected: dict[str, object], message: str
) -> None:
    path = tmp_path / f"x{suffix}"
    write(path, recording())
    with pytest.raises(RecordingError) as refused:
        read(path, **expected)  # type: ignore[arg-type]
    assert str(refused.value) == f"{path}: {message}"


@pytest.mark.parametrize("suffix", [".wav", ".csv"])
def test_what_is_expected_is_read(tmp_path: Path, suffix: str) -> None:
    write(tmp_path / f"x{suffix}", recording())
    assert same(read(tmp_path / f"x{suffix}", rate=44_100, channels=2, names=recording().names), recording())


@pytest.mark.parametrize("name", ["x.flac", "x", "x.wav.txt"])
def test_another_suffix_is_refused_for_reading_and_writing(tmp_path: Path, name: str) -> None:
    for attempt in (lambda: read(tmp_path / name), lambda: write(tmp_path / name, recording())):
        with pytest.raises(RecordingError, match=rf"{name}: suffix is '.*', must be one of .wav, .csv"):
            attempt()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", [".wav", ".csv"])
def test_a_file_that_is_not_there_a_folder_and_an_empty_file_are_refused(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"x{suffix}"
    with pytest.raises(RecordingError, match=rf"x{suffix}: No such file or directory"):
        read(path)
    path.touch()
    with pytest.raises(RecordingError, match=rf"x{suffix}: "):
        read(path)
    path.unlink()
    path.mkdir()
    with pytest.raises(RecordingError, match=rf"x{suffix}: Is a directory"):
        read(path)


@pytest.mark.parametrize("suffix", [".wav", ".csv"])
def test_a_write_into_no_folder_is_refused_with_the_path(tmp_path: Path, suffix: str) -> None:
    with pytest.raises(RecordingError, match=rf"nowhere/x{suffix}: "):
        write(tmp_path / "nowhere" / f"x{suffix}", recording())


# atomic


@pytest.mark.parametrize("suffix", [".wav", ".csv"])
def test_a_write_that_fails_half_way_leaves_the_file_before_and_nothing_else(
    tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / f"x{suffix}"
    write(path, recording())

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(RecordingError, match=rf"x{suffix}: No space left on device"):
        write(path, recording(data=-NOISE))
    assert same(read(path), recording())
    assert list(tmp_path.iterdir()) == [path]


def test_what_is_on_the_disk_is_synchronised_before_it_takes_the_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, sizes = tmp_path / "x.wav", []

    def look(handle: int) -> None:
        sizes.append(os.fstat(handle).st_size)
        assert not path.exists()

    monkeypatch.setattr(os, "fsync", look)
    write(path, recording())
    assert sizes == [path.stat().st_size]


KILLED = """
import sys, numpy as np
from ctlblocks.recording import Recording, write
n = 0
while True:
    n += 1
    write(sys.argv[1], Recording(("a",), ("1",), 1000.0, np.full((20000, 1), float(n))))
    if n == 1: print("ready", flush=True)
"""


@pytest.mark.parametrize("suffix", [".wav", ".csv"])
def test_killed_at_any_moment_the_file_is_whole(tmp_path: Path, suffix: str) -> None:
    path, seen = tmp_path / f"x{suffix}", set()
    for n in range(3):
        with subprocess.Popen([sys.executable, "-c", KILLED, path], stdout=subprocess.PIPE) as child:
            assert child.stdout is not None
            assert child.stdout.readline() == b"ready\n"
            for _ in range(40 * (n + 1)):
                path.stat()
            child.send_signal(signal.SIGKILL)
        data = read(path).data
        assert (data == data[0, 0]).all()
        seen.add(float(data[0, 0]))
    assert seen


# damaged


@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("suffix", [".wav", ".csv"])
def test_every_truncated_file_is_refused(tmp_path: Path, suffix: str, dtype: str) -> None:
    path = tmp_path / f"x{suffix}"
    write(path, recording(dtype, data=NOISE[:8].astype(dtype)))
    whole = path.read_bytes()
    for length in range(len(whole)):
        path.write_bytes(whole[:length])
        with pytest.raises(RecordingError, match=rf"x{suffix}: "):
            read(path)


@pytest.mark.parametrize("suffix", [".wav", ".csv"])
def test_a_byte_changed_anywhere_in_the_header_changes_no_rate_length_or_channel_in_silence(
    tmp_path: Path, suffix: str
) -> None:
    path, written = tmp_path / f"x{suffix}", recording()
    write(path, written)
    whole = path.read_bytes()
    header = len(whole) - written.data.nbytes if suffix == ".wav" else whole.index(b"\n")
    random = np.random.default_rng(3)
    for place in list(range(header)) * 3:
        changed = bytearray(whole)
        changed[place] = random.integers(256)
        path.write_bytes(changed)
        try:
            found = read(path)
        except RecordingError:
            continue
        assert found.data.astype("float32").tobytes() == written.data.tobytes()
        if suffix == ".wav":
            assert found.rate == written.rate


def test_a_wav_beyond_4_gb_is_an_rf64(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    written = recording()
    assert 2**32 - 2**18 < wav_file.LARGEST_WAV < 2**32 - wav_file.LONGEST_COMMENT - 4096
    for largest, magic in ((written.data.nbytes, b"RIFF"), (written.data.nbytes - 1, b"RF64")):
        monkeypatch.setattr(wav_file, "LARGEST_WAV", largest)
        write(tmp_path / "x.wav", written)
        assert (tmp_path / "x.wav").read_bytes()[:4] == magic
        assert same(read(tmp_path / "x.wav"), written)
