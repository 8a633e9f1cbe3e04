"""Frames: what goes in comes out, and nothing that was changed on the way does."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rigkit.wire.layout import LONG, NEVER, SHORT, Field, GarbledError, Layout, WireError
from stagectl.wire import messages
from stagectl.wire.messages import LAYOUTS

ANY = st.sampled_from(LAYOUTS)
RANGES = {"B": (0, 255), "H": (0, 65_535), "I": (0, 2**32 - 1), "Q": (0, 2**64 - 1), "h": (-32_768, 32_767)}


def a_value(field: Field) -> st.SearchStrategy[int]:
    return st.sampled_from([*map(int, field.choices)]) if field.choices else st.integers(*RANGES[field.kind])


def some_values(layout: Layout) -> st.SearchStrategy[tuple[int, ...]]:
    return st.tuples(*map(a_value, layout.fields))


@given(st.data(), ANY, st.integers(0, 2**64))
def test_what_is_packed_is_unpacked(data: st.DataObject, layout: Layout, counter: int) -> None:
    values = data.draw(some_values(layout))
    frame = layout.pack(counter, *values)
    assert len(frame) == layout.size
    assert layout.unpack(frame) == (counter % layout.modulus, values)


@given(st.data(), ANY)
def test_a_frame_with_any_burst_of_changed_bits_is_garbled(data: st.DataObject, layout: Layout) -> None:
    """As long as the checksum; longer ones are seen but for one in 256, or in 65536."""
    frame = layout.pack(7, *data.draw(some_values(layout)))
    bits = 8 if layout.size == SHORT else 16
    burst = data.draw(st.integers(1, 2**bits - 1)) << data.draw(st.integers(0, 8 * layout.size - bits))
    changed = (int.from_bytes(frame, "big") ^ burst).to_bytes(layout.size, "big")
    with pytest.raises(GarbledError, match="checksum"):
        layout.unpack(changed)


@given(st.binary(max_size=80).filter(lambda data: len(data) not in (SHORT, LONG)), ANY)
def test_a_frame_of_another_length_is_garbled(data: bytes, layout: Layout) -> None:
    with pytest.raises(GarbledError, match="bytes, must be"):
        layout.unpack(data)


def test_a_frame_under_another_identifier_is_garbled() -> None:
    frame = messages.POSITION.pack(1, *range(30))
    with pytest.raises(GarbledError, match="Extension: the checksum"):
        messages.EXTENSION.unpack(frame)


def test_a_value_that_is_no_choice_is_garbled() -> None:
    frame = messages.STAGE_HEARTBEAT.pack(0, 9, 0, 0)
    with pytest.raises(GarbledError, match=r"state is 9, must be one of \[0, 1, 2, 3, 4\]"):
        messages.STAGE_HEARTBEAT.unpack(frame)


@pytest.mark.parametrize("values", [(256, 0, 0), (1, 0), (1, 0, 0, 0), (-1, 0, 0)])
def test_values_that_do_not_fit_are_refused(values: tuple[int, ...]) -> None:
    with pytest.raises(WireError, match="Command"):
        messages.COMMAND.pack(0, *values)


def test_fields_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ValueError, match="16 bytes in a frame of 8"):
        Layout("Long", 1, "host", SHORT, (Field("one", "Q"), Field("two", "Q")), NEVER, "too long")


def test_no_two_frames_share_an_identifier_or_a_name() -> None:
    assert len(messages.BY_IDENTIFIER) == len(LAYOUTS) == len({layout.name for layout in LAYOUTS})


def test_a_counter_takes_what_a_frame_has_room_for() -> None:
    assert (messages.STAGE_HEARTBEAT.size, messages.STAGE_HEARTBEAT.modulus) == (SHORT, 256)
    assert (messages.POSITION.size, messages.POSITION.modulus) == (LONG, 65_536)
