"""A set of named parameters as one piece of bytes, to be sent in chunks, read back and then used as a whole."""

import struct
import zlib
from collections.abc import Mapping
from typing import Any

import numpy as np

from rigkit.wire.layout import GarbledError, WireError

LARGEST = 65_536
"""Bytes of a set at most."""
LONGEST_NAME = 63
MOST_DIMENSIONS = 3

_TYPES: dict[int, np.dtype[Any]] = {4: np.dtype("<f4"), 8: np.dtype("<f8")}
_CRC = struct.Struct("<I")


def pack_parameters(parameters: Mapping[str, np.ndarray]) -> bytes:
    """Return the bytes of a set, in the order given.

    Each parameter: length of its name (u8), name (ASCII), bytes of a number (u8, 4 or 8), dimensions (u8), each
    dimension (u16), the numbers row by row; all little endian.  At the end the CRC-32 of all before.

    Parameters
    ----------
    parameters : mapping of str to array, any shape of up to 3 dimensions, any unit, float32 or float64

    Raises
    ------
    WireError : a name, a type or a shape cannot be sent, a number is not finite, or the set is too large.
    """
    image = b"".join(_record(name, np.asarray(value)) for name, value in parameters.items())
    if len(image) + _CRC.size > LARGEST:
        raise WireError(f"the parameters take {len(image) + _CRC.size} bytes, must be <= {LARGEST}")
    return image + _CRC.pack(zlib.crc32(image))


def unpack_parameters(image: bytes) -> dict[str, np.ndarray]:
    """Return the parameters of a set, by name, each of its own shape.

    Raises
    ------
    GarbledError : the CRC-32 is wrong, or the bytes are no set.
    """
    body = image[: -_CRC.size]
    if len(image) < _CRC.size or checksum(image) != zlib.crc32(body):
        raise GarbledError(f"a parameter set of {len(image)} bytes has a wrong checksum")
    parameters: dict[str, np.ndarray] = {}
    place = 0
    try:
        while place < len(body):
            name, value, place = _parsed(body, place)
            if name in parameters:
                raise ValueError(f"there are two of {name}")
            parameters[name] = value
    except (IndexError, KeyError, ValueError, struct.error) as fault:
        raise GarbledError(f"a parameter set cannot be read at byte {place} of {len(body)}: {fault}") from None
    return parameters


def checksum(image: bytes) -> int:
    """Return the CRC-32 at the end of a set's bytes: its name, on the wire and in the status."""
    return int(_CRC.unpack(image[-_CRC.size :])[0])


def chunks(image: bytes, size: int) -> list[bytes]:
    """Cut a set into pieces of `size` bytes, the last filled up with zeros."""
    return [image[start : start + size].ljust(size, b"\0") for start in range(0, len(image), size)]


def _record(name: str, value: np.ndarray) -> bytes:
    if not (name.isascii() and name.isprintable() and 1 <= len(name) <= LONGEST_NAME):
        raise WireError(f"a parameter is called {name!r}, must be 1 to {LONGEST_NAME} ASCII characters")
    if value.dtype not in _TYPES.values() or value.ndim > MOST_DIMENSIONS or max(value.shape, default=1) > 0xFFFF:
        raise WireError(
            f"parameter {name} is {value.dtype} of shape {value.shape}, must be float32 or float64 of "
            f"up to {MOST_DIMENSIONS} dimensions"
        )
    if not np.isfinite(value).all():
        raise WireError(f"parameter {name} holds {value[~np.isfinite(value)].flat[0]}, must be finite")
    head = struct.pack(
        f"<B{len(name)}sBB{value.ndim}H", len(name), name.encode(), value.itemsize, value.ndim, *value.shape
    )
    return head + value.astype(_TYPES[value.itemsize]).tobytes()


def _parsed(body: bytes, place: int) -> tuple[str, np.ndarray, int]:
    length = body[place]
    name = body[place + 1 : place + 1 + length].decode("ascii")
    place += 1 + length
    kind, dimensions = _TYPES[body[place]], body[place + 1]
    shape = struct.unpack_from(f"<{dimensions}H", body, place + 2)
    place += 2 + 2 * dimensions
    count = int(np.prod(shape))
    value = np.frombuffer(body, kind, count, place).reshape(shape).astype(kind.newbyteorder("="))
    if not np.isfinite(value).all():
        raise ValueError(f"{name} is not finite")
    return name, value, place + count * kind.itemsize
