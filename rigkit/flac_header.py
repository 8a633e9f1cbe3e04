"""What a FLAC file says of its samples, in its head and again in its first frame."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

_RATES = (0, 88_200, 176_400, 192_000, 8_000, 16_000, 22_050, 24_000, 32_000, 44_100, 48_000, 96_000)
"""samples/s by their code in a frame; 0: as in the head."""
_SPELT = {12: (1, 1_000), 13: (2, 1), 14: (2, 10)}
"""Codes of rates that stand at the end of a frame's header: in how many bytes, in which unit."""
_BITS = {0: 0, 1: 8, 2: 12, 4: 16, 5: 20, 6: 24, 7: 32}
"""Bits of a sample by their code in a frame; 0: as in the head."""
BITS = (8, 16, 24)
"""Bits of a sample that libsndfile reads."""


@dataclass(frozen=True)
class FlacHeader:
    """What a FLAC file says of its samples.

    Parameters
    ----------
    rate : int, samples/s
    channels, bits : int
    frames : int
    checksum : bytes or None
        MD5 of all samples as `packed`.
    """

    rate: int
    channels: int
    bits: int
    frames: int
    checksum: bytes | None

    def packed(self, samples: np.ndarray) -> bytes:
        """Return samples, int32 array of shape (frames, channels), as the checksum wants them: its lowest bytes."""
        width = self.bits // 8
        return (samples >> (32 - self.bits)).astype("<i4").view(np.uint8).reshape(-1, 4)[:, :width].tobytes()


def flac_header(path: Path) -> FlacHeader:
    """Read what a file says.

    Parameters
    ----------
    path : Path

    Raises
    ------
    ValueError : no FLAC file, one without samples, or one whose first frame contradicts the head.

    Source
    ------
    RFC 9639, Free Lossless Audio Codec, sec. 8.2 (streaminfo) and 9.1 (frame header).
    """
    with path.open("rb") as file:
        start = file.read(42)
        if len(start) < 42 or start[:4] != b"fLaC" or start[4] & 127 != 0 or start[5:8] != b"\x00\x00\x22":
            raise ValueError("not a FLAC file, or its head is cut off")
        is_last, size = start[4] >= 128, path.stat().st_size
        while not is_last:
            block = file.read(4)
            if len(block) < 4 or file.seek(int.from_bytes(block[1:], "big"), 1) >= size:
                raise ValueError("the head is cut off, or holds blocks that end behind the file")
            is_last = block[0] >= 128
        frame = file.read(16)
    packed = int.from_bytes(start[18:26], "big")
    rate, channels, bits, frames = packed >> 44, (packed >> 41 & 7) + 1, (packed >> 36 & 31) + 1, packed & (1 << 36) - 1
    if bits not in BITS:
        raise ValueError(f"{bits} bits a sample, must be one of {', '.join(map(str, BITS))}")
    if frames == 0:
        raise ValueError("the head does not say how many samples there are: its writer was not ended")
    said = _of_frame(frame, rate, bits)
    if said != (rate, channels, bits):
        raise ValueError(
            f"the head says {rate} samples/s, {channels} channels, {bits} bits, the first frame {said[0]}, {said[1]}, "
            f"{said[2]}"
        )
    return FlacHeader(rate, channels, bits, frames, start[26:42] if any(start[26:42]) else None)


def _of_frame(frame: bytes, rate: int, bits: int) -> tuple[int, int, int]:
    """Return rate, channels and bits of a frame by its header; those of the head where it leaves them to that."""
    if len(frame) < 16 or frame[0] != 0xFF or frame[1] & 0xFE != 0xF8:
        raise ValueError("no samples behind the head")
    size, code, channels, depth = frame[2] >> 4, frame[2] & 15, frame[3] >> 4, frame[3] >> 1 & 7
    number = max(1, 8 - (frame[4] ^ 0xFF).bit_length())  # bytes of the frame's number, as of UTF-8
    place = 4 + number + {6: 1, 7: 2}.get(size, 0)
    if code in _SPELT:
        width, unit = _SPELT[code]
        found = unit * int.from_bytes(frame[place : place + width], "big")
    else:
        found = (_RATES[code] or rate) if code < len(_RATES) else -1
    return found, channels + 1 if channels < 8 else 2, _BITS.get(depth, -1) or bits
