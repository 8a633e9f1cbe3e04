"""The force sensor's datagrams: as ATI's manual prints them, and back."""

import numpy as np
import pytest

from rigkit.wire.layout import GarbledError, WireError
from stagectl.wire.force_sensor import Record, Request, pack_record, pack_request, unpack_records, unpack_request

COUNTS = np.repeat([1e6, 2e6], 3)


def test_requests_are_eight_bytes_big_endian() -> None:
    assert pack_request(Request.STREAM) == bytes.fromhex("1234 0002 00000000")
    assert pack_request(Request.STREAM, 258) == bytes.fromhex("1234 0002 00000102")
    assert pack_request(Request.STOP) == bytes.fromhex("1234 0000 00000000")
    assert pack_request(Request.BIAS) == bytes.fromhex("1234 0042 00000000")
    assert unpack_request(pack_request(Request.STREAM, 7)) == (Request.STREAM, 7)


def test_a_record_is_36_bytes_of_counters_status_and_counts() -> None:
    wrench = np.array([1.0, -2.0, 3.0, 0.1, -0.2, 0.3])
    data = pack_record(Record(0x01020304, 5, 0x88000000, wrench), COUNTS)
    assert data == bytes.fromhex("01020304 00000005 88000000 000f4240 ffe17b80 002dc6c0 00030d40 fff9e580 000927c0")
    (back,) = unpack_records(data, COUNTS)
    assert (back.counter, back.sample, back.status) == (0x01020304, 5, 0x88000000)
    np.testing.assert_allclose(back.wrench, wrench, atol=1e-12)


def test_a_datagram_may_have_several_records() -> None:
    data = b"".join(pack_record(Record(n, n, 0, np.full(6, float(n))), COUNTS) for n in range(3))
    assert [each.counter for each in unpack_records(data, COUNTS)] == [0, 1, 2]


@pytest.mark.parametrize("data", [b"", b"x" * 35, b"x" * 37])
def test_what_is_no_whole_record_is_refused(data: bytes) -> None:
    with pytest.raises(GarbledError, match="must be 36 a record"):
        unpack_records(data, COUNTS)


@pytest.mark.parametrize("data", [b"", bytes.fromhex("1235 0002 00000000"), bytes.fromhex("1234 0009 00000000")])
def test_what_is_no_request_is_refused(data: bytes) -> None:
    with pytest.raises(GarbledError, match="request to the force sensor"):
        unpack_request(data)


def test_a_force_beyond_32_bits_cannot_be_sent() -> None:
    with pytest.raises(WireError, match="must fit 32 bits"):
        pack_record(Record(0, 0, 0, np.array([3e3, 0, 0, 0, 0, 0])), COUNTS)
