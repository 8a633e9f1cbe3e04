"""What a force sensor's network box takes and sends over UDP: ATI's Raw Data Transfer, which others speak as well.

Big endian.  A request: 0x1234 (u16), command (u16), records wanted (u32, 0 for no end).  A record: its counter (u32),
the sensor's own counter (u32), status (u32, 0 for healthy), then forces x y z and moments x y z (6 i32, counts).  A
datagram has one record or more.  Counts become SI by what the box is set to.

Source: ATI Industrial Automation, Net F/T manual, RDT; status bits as in the Ethernet Axia manual (document 9610-05),
tables 4.7 and 4.9.
"""

import struct
from dataclasses import dataclass
from enum import IntEnum, IntFlag
from typing import Protocol

import numpy as np

from rigkit.wire.layout import GarbledError, WireError

PORT = 49_152
"""Where the box listens."""
MODULUS = 1 << 32
_HEADER = 0x1234
_REQUEST, _RECORD = struct.Struct(">HHI"), struct.Struct(">III6i")
_LARGEST = (1 << 31) - 1


class Request(IntEnum):
    """What the box can be asked for."""

    STOP = 0x0000
    STREAM = 0x0002
    BIAS = 0x0042


class Status(IntFlag):
    """What is wrong with the sensor."""

    GAGE_OUT_OF_RANGE = 1 << 27
    OUT_OF_RANGE = 1 << 30
    ERROR = 1 << 31


SATURATED = Status.GAGE_OUT_OF_RANGE | Status.OUT_OF_RANGE


@dataclass(frozen=True, eq=False)
class Record:
    """One sample of the sensor.

    Parameters
    ----------
    counter : int, of the records sent
    sample : int, of the sensor's own samples
    status : int, bits of `Status`
    wrench : array, shape (6,), N and N m
    """

    counter: int
    sample: int
    status: int
    wrench: np.ndarray


def pack_request(request: Request, records: int = 0) -> bytes:
    """Return a request's bytes; `records` to send, 0 for no end."""
    return _REQUEST.pack(_HEADER, request, records)


def unpack_request(data: bytes) -> tuple[Request, int]:
    """Return a request and how many records it wants; `GarbledError` where it is none."""
    if len(data) != _REQUEST.size:
        raise GarbledError(f"a request to the force sensor has {len(data)} bytes, must be {_REQUEST.size}")
    header, command, records = _REQUEST.unpack(data)
    if header != _HEADER or command not in Request.__members__.values():
        raise GarbledError(f"a request to the force sensor is {header:#x} {command:#x}, must be {_HEADER:#x} and known")
    return Request(command), records


def pack_record(record: Record, counts: np.ndarray) -> bytes:
    """Return a record's bytes.

    Parameters
    ----------
    record : Record
    counts : array, shape (6,), counts a N and a N m

    Raises
    ------
    WireError : what it measures does not fit.
    """
    values = np.rint(record.wrench * counts)
    if not np.all(np.abs(values) <= _LARGEST):
        raise WireError(f"the force sensor's wrench is {record.wrench}, must fit 32 bits at {counts} counts")
    return _RECORD.pack(
        record.counter % MODULUS, record.sample % MODULUS, record.status, *values.astype(np.int64).tolist()
    )


def unpack_records(data: bytes, counts: np.ndarray) -> list[Record]:
    """Return the records of a datagram.

    Parameters
    ----------
    data : bytes
    counts : array, shape (6,), 1/N and 1/(N m)
        As in `pack_record`.

    Raises
    ------
    GarbledError : it does not hold whole records.
    """
    if not data or len(data) % _RECORD.size:
        raise GarbledError(f"a datagram of the force sensor has {len(data)} bytes, must be {_RECORD.size} a record")
    return [Record(row[0], row[1], row[2], np.array(row[3:]) / counts) for row in _RECORD.iter_unpack(data)]


class ForceWire(Protocol):
    """A make's datagrams, without I/O.

    Attributes
    ----------
    modulus : int
        Where `Record.counter` begins again.
    start, stop : bytes
        What asks for the stream, and for its end.
    """

    modulus: int
    start: bytes
    stop: bytes

    def read(self, data: bytes, counts: np.ndarray) -> list[Record]:
        """Return a datagram's records; `counts`, shape (6,), 1/N and 1/(N m).  `GarbledError` where it holds none."""


class NetFt:
    """The box's datagrams as a `ForceWire`."""

    modulus = MODULUS
    start, stop = pack_request(Request.STREAM), pack_request(Request.STOP)

    def read(self, data: bytes, counts: np.ndarray) -> list[Record]:
        """Return a datagram's records, as `unpack_records` does; `counts`, shape (6,), 1/N and 1/(N m)."""
        return unpack_records(data, counts)
