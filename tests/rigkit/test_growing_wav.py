"""Files that grow: readable at any moment, whole after a kill or a fault of the disk at any of their system calls."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import soundfile

from ctlblocks import recording
from ctlblocks.wav_file import LARGEST_WAV
from rigkit.growing_wav import GROWING, Channels, GrowingWav, finish
from tests.rigkit.failing_calls import every_fault
from tests.rigkit.killed_stream import check, grow
from tests.until import EVER

CHANNELS = Channels(("a", "b"), ("V", "m/s^2"), 44_100.0, {"rig": "x"}, "float32")
NOISE = np.random.default_rng(1).normal(size=(300, 2)).astype("float32")


@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_it_is_a_recording_bit_for_bit(tmp_path: Path, dtype: str) -> None:
    noise = np.random.default_rng(1).normal(size=(301, 3)).astype(dtype)
    with GrowingWav(tmp_path / "x.wav", Channels(("a", "b", "c"), ("V", "1", "m"), 250.0, {}, dtype)) as file:
        for part in np.array_split(noise, 7):
            file.append(part)
    read = recording.read(tmp_path / "x.wav", rate=250, names=("a", "b", "c"))
    assert (read.units, read.data.dtype.name) == (("V", "1", "m"), dtype)
    assert read.data.tobytes() == noise.tobytes()
    assert [path.name for path in tmp_path.iterdir()] == ["x.wav"]


def test_any_program_can_read_it_while_it_grows(tmp_path: Path) -> None:
    with GrowingWav(tmp_path / "x.wav", CHANNELS) as file:
        for count in (100, 200, 300):
            file.append(NOISE[count - 100 : count])
            data, rate = soundfile.read(tmp_path / f"x{GROWING}", dtype="float32")
            assert rate == 44_100
            np.testing.assert_array_equal(data, NOISE[:count])
            np.testing.assert_array_equal(recording.read(tmp_path / f"x{GROWING}").data, NOISE[:count])


def test_a_file_without_a_sample_is_not_left(tmp_path: Path) -> None:
    GrowingWav(tmp_path / "x.wav", CHANNELS).close()
    assert list(tmp_path.iterdir()) == []


def test_nothing_is_overwritten(tmp_path: Path) -> None:
    (tmp_path / "x.wav").write_text("years of work")
    with pytest.raises(FileExistsError, match="there is such a file already"):
        GrowingWav(tmp_path / "x.wav", CHANNELS)
    with GrowingWav(tmp_path / "y.wav", CHANNELS) as file:
        file.append(NOISE)
        (tmp_path / "y.wav").write_text("years of work")
    assert {path.name for path in tmp_path.iterdir()} == {"x.wav", "y.wav", "y-again-1.wav"}
    assert (tmp_path / "y.wav").read_text() == "years of work"


def test_it_does_not_grow_beyond_what_a_wav_can_say(tmp_path: Path) -> None:
    with GrowingWav(tmp_path / "x.wav", CHANNELS) as file:
        file.frames = LARGEST_WAV // CHANNELS.frame - 100
        with pytest.raises(ValueError, match=rf"x\.wav: more than {LARGEST_WAV} bytes"):
            file.append(NOISE)
        file.frames = 0


@pytest.mark.parametrize(
    ("channels", "words"),
    [
        (Channels(("a",), ("1",), 440.5, {}), "1 channels at 440.5 samples/s, must be 1 to 1024 at a whole number"),
        (Channels((), (), 440.0, {}), "0 channels at 440 samples/s"),
        (Channels(("a",), ("1",), 1e9, {}), "less than 4 GB/s, here 8e[+]09"),
        (Channels(("a",), ("1",), 1.0, {"text": "x" * 50_000}), "provenance take 500.. bytes, must be <= 50000"),
    ],
)
def test_what_a_wav_cannot_hold_is_refused_before_a_file_is_made(
    tmp_path: Path, channels: Channels, words: str
) -> None:
    with pytest.raises(ValueError, match=words):
        GrowingWav(tmp_path / "x.wav", channels)
    assert list(tmp_path.iterdir()) == []


def test_a_header_that_was_cut_off_is_taken_away_and_one_that_is_damaged_is_left(tmp_path: Path) -> None:
    header, growing = CHANNELS.header(), tmp_path / f"x{GROWING}"
    for length in range(len(header) + CHANNELS.frame):
        growing.write_bytes((header + NOISE[:1].tobytes())[:length])
        assert finish(growing) is None
        assert list(tmp_path.iterdir()) == []
    for place in (0, 8, 12, 32, 36, len(header) - 8):
        damaged = bytearray(header + NOISE.tobytes())
        damaged[place] = 0
        growing.write_bytes(damaged)
        with pytest.raises(ValueError, match=r"x\.part\.wav: its header is damaged; it is left as it is"):
            finish(growing)
        assert growing.read_bytes() == damaged


def test_a_call_that_fails_is_an_error_that_names_the_file_and_leaves_no_part_of_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    failed = 0
    for folder, fault in every_fault(lambda place: grow(place / "x.wav", lambda: None), tmp_path, monkeypatch):
        check(folder)
        if fault is not None:
            failed += 1
            assert isinstance(fault, OSError)
            assert Path(fault.filename).name in ("x.wav", "x.part.wav", folder.name)
    assert failed >= 90


@pytest.mark.parametrize(("kind", "count", "fewest"), [("steps", 0, 30), ("random", 20, 20)])
def test_killed_at_any_moment_it_is_made_whole(kind: str, count: int, fewest: int, tmp_path: Path) -> None:
    assert _kills(kind, count, tmp_path) >= fewest


@pytest.mark.slow
def test_killed_at_200_moments_it_is_made_whole(tmp_path: Path) -> None:
    assert _kills("random", 200, tmp_path) == 200


def _kills(kind: str, count: int, folder: Path) -> int:
    command = [sys.executable, "-m", "tests.rigkit.killed_stream", kind, str(folder / "kept"), str(count)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=EVER, check=False)
    assert done.returncode == 0, done.stderr
    kills, samples = map(int, done.stdout.split())
    assert samples > 0
    return kills
