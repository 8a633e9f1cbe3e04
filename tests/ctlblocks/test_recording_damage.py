"""Files of recordings when a write fails, is killed, or a byte is lost or changed."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from ctlblocks.recording import RecordingError, read, write
from tests.ctlblocks.small_recordings import NOISE, recording, same


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
