"""The form of one frame: its fields, its counter, its checksum; from values to bytes and back."""

import math
import struct
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Literal

from rigkit.wire.checksum import crc8, crc16

SHORT, LONG = 8, 64
"""Bytes of a frame: as classic CAN carries, and as CAN FD does."""


class WireError(ValueError):
    """A value that no frame can carry."""


class GarbledError(WireError):
    """Bytes that are no such frame: wrong length, checksum or value."""


@dataclass(frozen=True)
class Field:
    """One number in a frame.

    Parameters
    ----------
    name : str
    kind : str, a code of `struct`: B, H, I, Q or h
    scale : float, `unit` per count
    unit : str, as a CAN tool shows it; "" for a count
    choices : IntEnum class or None
        The only values allowed.
    """

    name: str
    kind: Literal["B", "H", "I", "Q", "h"]
    scale: float = 1.0
    unit: str = ""
    choices: type[IntEnum] | None = None

    @property
    def bits(self) -> int:
        """Length on the wire."""
        return 8 * struct.calcsize(self.kind)


@dataclass(frozen=True)
class Layout:
    """A frame: the fields, little endian, from byte 0; zeros; then a counter and a checksum, which are in every frame.

    A short frame has room for 6 bytes, a counter modulo 256 and a CRC-8; a long one for 60 bytes, a counter modulo
    65536 and a CRC-16.  The checksum is over the identifier (two bytes, little endian) and all bytes before it.

    Parameters
    ----------
    name : str
    identifier : int, 11 bits; the lower goes first on a busy bus
    sender : str, such as "host"
    size : int, bytes, `SHORT` or `LONG`
    fields : tuple of Field
    period : float, s between two of them at most; infinite where it is sent on demand
    purpose : str
    """

    name: str
    identifier: int
    sender: str
    size: int
    fields: tuple[Field, ...]
    period: float
    purpose: str
    _body: struct.Struct = field(init=False, repr=False, compare=False)
    _start: int = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Refuse fields that do not fit."""
        used = struct.calcsize("<" + self._kinds)
        room = self.size - (2 if self.size == SHORT else 4)
        if self.size not in (SHORT, LONG) or used > room or not 0 <= self.identifier < 1 << 11:
            raise ValueError(f"{self.name}: {used} bytes in a frame of {self.size}, must fit; id {self.identifier:#x}")
        body = struct.Struct(f"<{self._kinds}{room - used}x{'B' if self.size == SHORT else 'H'}")
        object.__setattr__(self, "_body", body)
        object.__setattr__(self, "_start", self._crc(self.identifier.to_bytes(2, "little")))

    @property
    def modulus(self) -> int:
        """Where the counter begins again."""
        return 1 << 8 if self.size == SHORT else 1 << 16

    @property
    def is_fd(self) -> bool:
        """Whether only CAN FD carries it."""
        return self.size > SHORT

    @property
    def _kinds(self) -> str:
        return "".join(each.kind for each in self.fields)

    def pack(self, counter: int, *values: int) -> bytes:
        """Return the frame's bytes.

        Parameters
        ----------
        counter : int, taken modulo `modulus`
        values : int, one a field

        Raises
        ------
        WireError : a value does not fit its field, or there are too many or too few.
        """
        try:
            body = self._body.pack(*values, counter % self.modulus)
        except struct.error as fault:
            raise WireError(f"{self.name}: {values} cannot be sent: {fault}") from None
        return body + self._sum(body).to_bytes(self.size - len(body), "little")

    def unpack(self, data: bytes) -> tuple[int, tuple[int, ...]]:
        """Return the counter and the values of a frame.

        Parameters
        ----------
        data : bytes, `size` of them

        Raises
        ------
        GarbledError : the length or the checksum is wrong, or a value is none of its field's choices.
        """
        if len(data) != self.size:
            raise GarbledError(f"{self.name}: {len(data)} bytes, must be {self.size}")
        body = data[: self._body.size]
        if (sent := int.from_bytes(data[self._body.size :], "little")) != (computed := self._sum(body)):
            raise GarbledError(f"{self.name}: the checksum is {sent:#x}, must be {computed:#x}")
        *values, counter = self._body.unpack(body)
        for each, value in zip(self.fields, values, strict=True):
            if each.choices is not None and value not in each.choices.__members__.values():
                raise GarbledError(
                    f"{self.name}: {each.name} is {value}, must be one of {list(map(int, each.choices))}"
                )
        return counter, tuple(values)

    def _sum(self, body: bytes) -> int:
        return crc8(body, self._start) if self.size == SHORT else crc16(body, self._start)

    def _crc(self, data: bytes) -> int:
        return crc8(data) if self.size == SHORT else crc16(data)


NEVER = math.inf
"""Period of a frame that is sent on demand."""
