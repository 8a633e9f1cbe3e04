"""What an optical tracker sends over TCP: poses of several frames with a time stamp, in packets that can be told apart.

Trackers speak languages of their makers; this one is for the gateway that stands beside such a tracker.  Little endian:
`TRK1`, bytes in all (u16), frames (u16), counter (u32), time (u64, us, the tracker's clock); then for each frame its
number (u8), LEDs seen (u8), rms residual (f32, m), position (3 f64, m) and unit quaternion w x y z (4 f64); at the end
a CRC-16 over all before it.  A frame of which too few LEDs are seen is sent with its LEDs and NaN.
"""

import struct
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from rigkit.wire.checksum import crc16
from rigkit.wire.layout import WireError

MODULUS = 1 << 32
MAGIC = b"TRK1"
_HEAD, _FRAME, _SUM = struct.Struct("<4sHHIQ"), struct.Struct("<BBf7d"), struct.Struct("<H")
MOST_FRAMES = 64


@dataclass(frozen=True, eq=False)
class Sighting:
    """One frame of space as seen once: its number, LEDs seen, rms residual (m), pose, shape (7,), m and 1."""

    frame: int
    leds: int
    residual: float
    pose: np.ndarray


@dataclass(frozen=True)
class Sample:
    """All that was seen at one time.

    Parameters
    ----------
    counter : int
    time : float, s, the tracker's clock
    sightings : tuple of Sighting
    """

    counter: int
    time: float
    sightings: tuple[Sighting, ...]


class TrackerWire(Protocol):
    """A make's stream of bytes, cut into samples, without I/O.

    Attributes
    ----------
    modulus : int
        Where `Sample.counter` begins again.
    garbled : int
        Pieces of the stream that were no sample.
    """

    modulus: int
    garbled: int

    def take(self, data: bytes) -> list[Sample]:
        """Return the samples that `data` completes, in the order they come."""

    def forget(self) -> None:
        """Begin anew: the line was down."""


def pack_sample(sample: Sample) -> bytes:
    """Return a sample's bytes; `WireError` where it has too many frames."""
    count = len(sample.sightings)
    if count > MOST_FRAMES:
        raise WireError(f"a tracker's sample has {count} frames, must be at most {MOST_FRAMES}")
    size = _HEAD.size + count * _FRAME.size + _SUM.size
    data = _HEAD.pack(MAGIC, size, count, sample.counter % MODULUS, round(1e6 * sample.time))
    for each in sample.sightings:
        data += _FRAME.pack(each.frame, each.leds, each.residual, *each.pose.tolist())
    return data + _SUM.pack(crc16(data))


class Packets:
    """Cuts a stream of bytes into samples, finds the next one after rubbish, and counts what was none."""

    modulus = MODULUS

    def __init__(self) -> None:
        self.garbled = 0
        self._rest = b""

    def take(self, data: bytes) -> list[Sample]:
        """Return the samples that `data` completes, in the order they come."""
        self._rest += data
        found: list[Sample] = []
        while (start := self._rest.find(MAGIC)) >= 0:
            self.garbled += start > 0
            self._rest = self._rest[start:]
            if len(self._rest) < _HEAD.size:
                return found
            _, size, count, counter, time = _HEAD.unpack_from(self._rest)
            if count > MOST_FRAMES or size != _HEAD.size + count * _FRAME.size + _SUM.size:
                self._skip()
                continue
            if len(self._rest) < size:
                return found
            packet = self._rest[:size]
            if _SUM.unpack_from(packet, size - _SUM.size)[0] != crc16(packet[: -_SUM.size]):
                self._skip()
                continue
            self._rest = self._rest[size:]
            found.append(Sample(counter, 1e-6 * time, tuple(_sightings(packet, count))))
        self._rest = self._rest[1 - len(MAGIC) :]
        return found

    def forget(self) -> None:
        """Begin anew: the line was down."""
        self._rest = b""

    def _skip(self) -> None:
        self.garbled += 1
        self._rest = self._rest[len(MAGIC) :]


def _sightings(packet: bytes, count: int) -> list[Sighting]:
    rows = (_FRAME.unpack_from(packet, _HEAD.size + n * _FRAME.size) for n in range(count))
    return [Sighting(row[0], row[1], row[2], np.array(row[3:])) for row in rows]
