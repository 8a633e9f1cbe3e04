"""A parameter set: bit for bit or not at all."""

import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from rigkit.wire.layout import GarbledError, WireError
from stagectl.wire.parameters import LARGEST, checksum, chunks, pack_parameters, unpack_parameters

NAMES = st.text("abcxyz_.0123456789", min_size=1, max_size=20)
FINITE = {"allow_nan": False, "allow_infinity": False}
VALUES = st.sampled_from((np.float32, np.float64)).flatmap(
    lambda kind: arrays(kind, array_shapes(min_dims=0, max_dims=3, max_side=4), elements=dict(FINITE))
)
SETS = st.dictionaries(NAMES, VALUES, max_size=5)
SET = {"gains": np.arange(6.0).reshape(2, 3), "corner": np.array(80.0, np.float32)}


@given(SETS)
def test_a_set_comes_back_bit_for_bit(parameters: dict[str, np.ndarray]) -> None:
    back = unpack_parameters(pack_parameters(parameters))
    assert list(back) == list(parameters)
    for name, value in parameters.items():
        assert (back[name].dtype, back[name].shape) == (value.dtype, value.shape)
        assert back[name].tobytes() == value.tobytes()


@given(SETS, st.data())
def test_a_set_with_a_changed_byte_is_garbled(parameters: dict[str, np.ndarray], data: st.DataObject) -> None:
    image = bytearray(pack_parameters(parameters))
    image[data.draw(st.integers(0, len(image) - 1))] ^= data.draw(st.integers(1, 255))
    with pytest.raises(GarbledError, match="checksum"):
        unpack_parameters(bytes(image))


@given(st.binary(max_size=60))
def test_bytes_that_are_no_set_are_garbled_whatever_their_checksum(body: bytes) -> None:
    image = body + zlib.crc32(body).to_bytes(4, "little")
    try:
        assert pack_parameters(unpack_parameters(image)) == image
    except GarbledError as fault:
        assert "cannot be read at byte" in str(fault)  # noqa: PT017 (most sets raise, some are sets)


@pytest.mark.parametrize("size", [4, 58])
def test_chunks_put_together_are_the_set(size: int) -> None:
    image = pack_parameters(SET)
    pieces = chunks(image, size)
    assert {len(piece) for piece in pieces} == {size}
    assert b"".join(pieces)[: len(image)] == image
    assert not any(b"".join(pieces)[len(image) :])


def test_a_set_is_known_by_its_checksum() -> None:
    assert checksum(pack_parameters(SET)) == zlib.crc32(pack_parameters(SET)[:-4])


@pytest.mark.parametrize(
    ("parameters", "text"),
    [
        ({"a": np.array([1.0, np.nan])}, "parameter a holds nan, must be finite"),
        ({"a": np.array([1])}, "is int64 of shape"),
        ({"a": np.zeros((1, 1, 1, 1))}, "up to 3 dimensions"),
        ({"": np.zeros(1)}, "called ''"),
        ({"gr\u00f6sse": np.zeros(1)}, "ASCII"),
        ({"a": np.zeros(LARGEST // 8)}, "must be <= 65536"),
    ],
)
def test_what_cannot_be_sent_is_refused(parameters: dict[str, np.ndarray], text: str) -> None:
    with pytest.raises(WireError, match=text):
        pack_parameters(parameters)


def test_two_of_a_name_are_garbled() -> None:
    body = pack_parameters({"a": np.zeros(1)})[:-4] * 2
    with pytest.raises(GarbledError, match="there are two of a"):
        unpack_parameters(body + zlib.crc32(body).to_bytes(4, "little"))
