"""WAV files: samples in their own precision, names and units in the comment, every length checked against the file."""

import json
import struct
from io import FileIO
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import soundfile

LARGEST_WAV = 2**32 - 2**17
"""Bytes of samples beyond which the container is RF64: what four-byte lengths can say, less room for the header."""
LONGEST_COMMENT = 50_000
"""Bytes.  libsndfile 1.2.2 drops a comment of more than 51 195 bytes in silence (and reads no more than 2045 back)."""
MARK = b'{"ctlblocks": 1, '
_PLAIN = {"FLOAT": "float32", "PCM_16": "float32", "PCM_24": "float32", "PCM_32": "float64", "DOUBLE": "float64"}


def write(path: Path, data: np.ndarray, rate: float, about: dict[str, Any]) -> None:
    """Write samples, shape (frames, channels), float32 or float64, and `about`; ValueError where a WAV cannot."""
    comment = MARK.decode() + json.dumps(about)[1:]
    if len(comment) > LONGEST_COMMENT:
        raise ValueError(f"names, units and provenance take {len(comment)} bytes, must be <= {LONGEST_COMMENT}")
    if not rate.is_integer() or rate >= 2**31 or data.shape[1] > 1024:
        raise ValueError(f"{data.shape[1]} channels at {rate} samples/s, must be <= 1024 at a whole number < 2^31")
    kind, subtype = "WAV" if data.nbytes <= LARGEST_WAV else "RF64", "DOUBLE" if data.dtype == float else "FLOAT"
    with path.open("wb+", buffering=0) as file:
        target = _Target(file)
        try:
            with soundfile.SoundFile(target, "w", int(rate), data.shape[1], subtype, format=kind) as sound:
                sound.comment = comment
                sound.write(data)
        except (soundfile.SoundFileError, AssertionError):
            if target.fault is None:
                raise
        if target.fault is not None:
            raise target.fault


class Header(NamedTuple):
    """What a WAV says of its samples: how many, how wide, how fast, how written; `about` is empty in one of others."""

    frames: int
    channels: int
    rate: int
    subtype: str
    about: dict[str, Any]


def read(path: Path) -> tuple[np.ndarray, float, dict[str, Any]]:
    """Read samples, rate and `about` (empty in a WAV of others); ValueError where header, samples and size disagree."""
    said = header(path)
    with soundfile.SoundFile(path) as file:
        data = file.read(dtype=_PLAIN[said.subtype], always_2d=True)
    if data.shape != said[:2]:
        found = *data.shape, said.rate
        raise ValueError(f"samples, channels, samples/s are {found}, the header says {said[:3]}")
    return data, float(said.rate), said.about


def header(path: Path) -> Header:
    """Read what a WAV says of its samples; ValueError where that and the size of the file disagree."""
    chunks, size = _chunks(path)
    if len(chunks.get(b"fmt ", b"")) < 16 or size == 0:
        raise ValueError("the WAV has no samples, or no header that says what they are")
    channels, rate, bytes_a_second, align, bits = struct.unpack("<HIIHH", chunks[b"fmt "][2:16])
    if align == 0 or align != channels * -(-bits // 8) or bytes_a_second != rate * align or size % align:
        raise ValueError(
            f"the header does not add up: {channels} channels of {bits} bits in {align} bytes, {rate} samples/s in "
            f"{bytes_a_second} bytes/s, {size} bytes of samples"
        )
    with soundfile.SoundFile(path) as file:
        kind, found, said = file.subtype, (file.frames, file.channels, file.samplerate), (size // align, channels, rate)
    if kind not in _PLAIN:
        raise ValueError(f"samples are {kind}, must be one of {', '.join(_PLAIN)}")
    if found != said:
        raise ValueError(f"samples, channels, samples/s are {found}, the header says {said}")
    comment = chunks.get(b"LIST", b"").partition(MARK)[2].partition(b"\0")[0]
    return Header(*said, kind, json.loads(b"{" + comment) if comment else {})


class _Target:
    """A file as libsndfile writes to it, which keeps the first fault: the library says "System error." of them all."""

    def __init__(self, file: FileIO) -> None:
        self._file = file
        self.fault: OSError | None = None
        self.seek, self.tell, self.read = file.seek, file.tell, file.read

    def write(self, content: bytes) -> int:
        done = 0
        try:
            while done < len(content):  # a disk that is nearly full takes a part, and then says so
                done += self._file.write(content[done:])
        except OSError as fault:
            self.fault = self.fault or fault
        return done


def _chunks(path: Path) -> tuple[dict[bytes, bytes], int]:
    """Return the content of every chunk but the samples by name, and how many bytes of samples there are."""
    size = path.stat().st_size
    chunks: dict[bytes, bytes] = {}
    with path.open("rb") as file:
        head = file.read(36)
        if len(head) < 36 or head[:4] not in (b"RIFF", b"RF64") or head[8:12] != b"WAVE":
            raise ValueError(f"not a WAV file, or its header is cut off ({size} bytes)")
        whole, samples = int.from_bytes(head[4:8], "little"), 0
        if head[:4] == b"RF64":
            whole, samples = struct.unpack("<QQ", head[20:36])
        if not whole + 8 <= size <= whole + 9:
            raise ValueError(f"the header says {whole + 8} bytes, the file has {size}")
        start = 12
        while start + 8 <= size:
            file.seek(start)
            name, length = struct.unpack("<4sI", file.read(8))
            if name == b"data":
                if head[:4] == b"RF64" and length not in (2**32 - 1, samples):
                    raise ValueError(f"the header says {samples} bytes of samples, and again {length}")
                samples = length = samples or length
            start += 8 + length + length % 2
            if start > size + 1 or (name in chunks and name in (b"fmt ", b"data")):
                raise ValueError(f"the chunk {name!r} of {length} bytes ends behind the file, or comes twice")
            chunks[name] = b"" if name == b"data" else chunks.get(name, b"") + file.read(length)
    return chunks, samples if b"data" in chunks else 0
