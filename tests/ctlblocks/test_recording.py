"""Recordings, and their files as a whole: round trips and refusals.  The formats have tests of their own."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from ctlblocks import wav_file
from ctlblocks.recording import RecordingError, read, write
from tests.ctlblocks.small_recordings import NOISE, recording, same


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
        ({"names": ("a", "b\nc")}, "names are .*, must be 2 printable"),
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


def test_a_wav_beyond_4_gb_is_an_rf64(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    written = recording()
    assert 2**32 - 2**18 < wav_file.LARGEST_WAV < 2**32 - wav_file.LONGEST_COMMENT - 4096
    for largest, magic in ((written.data.nbytes, b"RIFF"), (written.data.nbytes - 1, b"RF64")):
        monkeypatch.setattr(wav_file, "LARGEST_WAV", largest)
        write(tmp_path / "x.wav", written)
        assert (tmp_path / "x.wav").read_bytes()[:4] == magic
        assert same(read(tmp_path / "x.wav"), written)
