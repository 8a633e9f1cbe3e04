"""Streams whose writer is killed: `python -m tests.rigkit.killed_stream KIND FOLDER COUNT`.

KIND is `steps`, a file killed at its first system call, then at its second and so on until it is through, or `random`,
a recorder killed at COUNT random moments.  Prints how many kills there were, and how many samples were on the disk.
"""

import os
import random
import shutil
import signal
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import soundfile

from ctlblocks import recording
from ctlblocks.block import Port
from rigkit import growing_wav, stream_recorder
from rigkit.growing_wav import Channels, GrowingWav, finish, unfinished
from rigkit.stream_recorder import StreamRecorder
from rigkit.stream_writer import Stream
from tests.rigkit.killed_run import in_a_child, kill_at

RATE, FRAMES, BLOCKS = 10_000.0, 50, 4


def ramp(first: int, count: int) -> np.ndarray:
    number = np.arange(first, first + count, dtype=float)
    return np.column_stack((number, -number))


def grow(path: Path, reached: Callable[[], None]) -> None:
    with GrowingWav(path, Channels(("a", "b"), ("V", "m"), RATE, {"first_sample": "0"})) as file:
        for block in range(BLOCKS):
            file.append(ramp(block * FRAMES, FRAMES))
            reached()
            file.synchronise()


def record(path: Path, told: int) -> None:
    """Record until killed, and tell how much is on the disk."""
    recorder = StreamRecorder(Stream(path, (Port("a", "V"), Port("b", "m")), ("a", "b"), longest=100_000), _quiet)
    recorder.prepare(RATE, FRAMES)
    with recorder:
        for block in range(1_000_000):
            data = ramp(block * FRAMES, FRAMES)
            recorder.process(data[:, :1], data[:, 1:])
            os.write(told, recorder.recorded.to_bytes(8, "little"))


def _quiet(*_: object) -> None:
    pass


def check(folder: Path) -> int:
    """Finish what a kill left; every file must hold what was recorded, from its first sample.  Return the samples."""
    for path in unfinished(folder):
        size = path.stat().st_size
        if size > 400:  # its header is there: others can read it already
            assert soundfile.read(path, always_2d=True)[0].shape[1] == 2
        finish(path)
    kept = 0
    for path in folder.glob("*.wav"):
        read = recording.read(path, rate=RATE, names=("a", "b"))
        assert read.units == ("V", "m")
        assert (read.data == ramp(int(read.provenance["first_sample"]), len(read.data))).all()
        kept += len(read.data)
    assert not list(unfinished(folder))
    return kept


def steps(folder: Path, _: int) -> tuple[int, int]:
    for step in range(1, 10_000):
        _clear(folder)
        _, status = os.waitpid(in_a_child(lambda step=step: grow(folder / "x.wav", kill_at(step))), 0)
        kept = check(folder)
        if not os.WIFSIGNALED(status):
            assert (status, kept) == (0, BLOCKS * FRAMES)
            return step - 1, kept
    raise AssertionError("the file has no end")


def at_random(folder: Path, count: int) -> tuple[int, int]:
    chance, most = random.Random(8), 0
    stream_recorder.PERIOD = 1e-4
    for _ in range(count):
        _clear(folder)
        told, tell = os.pipe()
        child = in_a_child(lambda tell=tell: record(folder / "x.wav", tell))
        os.close(tell)
        for _ in range(chance.randint(1, 400)):
            heard = os.read(told, 8)
        os.kill(child, signal.SIGKILL)
        assert os.WIFSIGNALED(os.waitpid(child, 0)[1])
        os.close(told)
        kept = check(folder)
        assert kept >= int.from_bytes(heard, "little")  # what was told to be on the disk is
        most = max(most, kept)
    return count, most


def _clear(folder: Path) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()


if __name__ == "__main__":
    os.fsync = os.fstat  # does nothing: a kill does not undo what the kernel has, and some disks take 10 ms to sync
    growing_wav.to_disk = lambda _: None
    kind, place, number = sys.argv[1:]
    kills, samples = {"steps": steps, "random": at_random}[kind](Path(place), int(number))
    sys.stdout.write(f"{kills} {samples}")
