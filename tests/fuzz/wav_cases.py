"""Damaged WAV files, and what each must be read as if it is."""

import io
import random
import struct
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import soundfile

from ctlblocks import recording
from ctlblocks.recording import Recording, RecordingError
from rigkit.growing_wav import GROWING, Channels, GrowingWav, finish
from tests.fuzz.judge import is_accepted
from tests.fuzz.mutation import mutated, of_bytes


def cases(folder: Path) -> Callable[[int], bool]:
    """Return what reads the damaged file of a number, and says whether it was accepted."""
    sound, path = _sound(), folder / "x.wav"

    def case(number: int) -> bool:
        chance = random.Random(number)
        content = mutated(chance.choice(sound), chance, sound, of_bytes)
        path.write_bytes(content)
        return is_accepted(lambda: recording.read(path), partial(_check, content), RecordingError)

    return case


def growing_cases(folder: Path) -> Callable[[int], bool]:
    """Return what makes a damaged growing file whole, reads it, and says whether there was something in it."""
    sound = _sound()[-1:]

    def case(number: int) -> bool:
        chance = random.Random(number)
        path = folder / f"x{GROWING}"
        path.write_bytes(mutated(sound[0], chance, sound, of_bytes))
        made: list[Path | None] = []
        if not is_accepted(lambda: finish(path), made.append, ValueError) or made[0] is None:
            return False
        whole = made[0]
        content = whole.read_bytes()
        try:
            return is_accepted(lambda: recording.read(whole), partial(_check, content), RecordingError)
        finally:
            whole.unlink()

    return case


def _check(content: bytes, read: Recording) -> None:
    """Compare rate, channels and length with those of the file, and every sample that is a float."""
    chunks = _chunks(content)
    kind, channels, rate, _, align, _ = struct.unpack("<HHIIHH", chunks[b"fmt "][:16])
    data = chunks[b"data"]
    assert read.rate == rate, f"{read.rate} samples/s of {rate}"
    assert read.data.shape == (len(data) // align, channels), f"{read.data.shape} of {len(data)} bytes"
    assert np.isfinite(read.data).all(), "NaN"
    if kind == 3:
        assert read.data.tobytes() == np.frombuffer(data, f"<f{align // channels}").tobytes(), "other samples"


def _chunks(content: bytes) -> dict[bytes, bytes]:
    chunks: dict[bytes, bytes] = {}
    start, large = 12, 0
    while start + 8 <= len(content):
        name, length = struct.unpack_from("<4sI", content, start)
        if name == b"ds64":
            large = struct.unpack_from("<Q", content, start + 16)[0]
        if name == b"data" and length == 0xFFFFFFFF:
            length = large
        chunks.setdefault(name, content[start + 8 : start + 8 + length])
        start += 8 + length + length % 2
    return chunks


def _sound() -> list[bytes]:
    noise = np.random.default_rng(1).normal(size=(120, 2)) / 4
    files = [_ours(noise.astype("float32")), _ours(noise[:, :1])]
    for kind, subtype in (
        ("WAV", "PCM_16"), ("WAV", "PCM_24"), ("WAV", "FLOAT"), ("WAVEX", "FLOAT"), ("WAVEX", "PCM_32"),
        ("RF64", "DOUBLE"),
    ):  # fmt: skip
        file = io.BytesIO()
        soundfile.write(file, noise, 48_000, subtype, format=kind)
        files.append(file.getvalue())
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "x.wav"
        with GrowingWav(path, Channels(("a", "b"), ("V", "m"), 10_000.0, {"rig": "x"})) as grown:
            grown.append(noise)
        files.append(path.read_bytes())
    return files


def _ours(noise: np.ndarray) -> bytes:
    names = ("drive", "response")[: noise.shape[1]]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "x.wav"
        recording.write(path, Recording(names, ("V", "m/s^2")[: len(names)], 44_100, noise, {"rig": "x"}))
        return path.read_bytes()
