"""stagectl/stage.dbc says what the code says, read by cantools as anybody's CAN tool would."""

from pathlib import Path

import cantools
import pytest
from cantools.database.can import Database
from hypothesis import given
from hypothesis import strategies as st

import stagectl
from rigkit.wire.layout import Layout
from stagectl.wire.dbc import dbc_text
from stagectl.wire.messages import LAYOUTS, STATUS
from tests.stagectl.wire.test_layout import ANY, some_values

FILE = Path(stagectl.__file__).parent / "stage.dbc"
LOADED = cantools.database.load_file(FILE)
assert isinstance(LOADED, Database)


def test_the_file_is_the_one_the_code_writes() -> None:
    """`make docs` writes it."""
    assert FILE.read_text() == dbc_text()


def test_it_holds_every_frame_and_no_other() -> None:
    found = {(message.frame_id, message.name, message.length, message.is_fd) for message in LOADED.messages}
    assert found == {(layout.identifier, layout.name, layout.size, layout.is_fd) for layout in LAYOUTS}


@pytest.mark.parametrize("layout", LAYOUTS, ids=lambda layout: layout.name)
def test_senders_units_and_periods_are_those_of_the_code(layout: Layout) -> None:
    message = LOADED.get_message_by_frame_id(layout.identifier)
    assert message.senders == [layout.sender.capitalize()]
    assert message.comment == layout.purpose
    assert (message.cycle_time or None) == (None if layout.period > 1e9 else round(1000 * layout.period))
    units = {signal.name: signal.unit or "" for signal in message.signals}
    assert units == {field.name: field.unit for field in layout.fields} | {"counter": "", "checksum": ""}


@given(st.data(), ANY, st.integers(0, 255))
def test_cantools_reads_what_the_code_packs(data: st.DataObject, layout: Layout, counter: int) -> None:
    values = data.draw(some_values(layout))
    frame = layout.pack(counter, *values)
    message = LOADED.get_message_by_frame_id(layout.identifier)
    raw = message.decode(frame, decode_choices=False, scaling=False)
    assert [raw[field.name] for field in layout.fields] == list(values)
    assert raw["counter"] == counter
    assert raw["checksum"] == int.from_bytes(frame[-(1 if layout.size == 8 else 2) :], "little")
    scaled = message.decode(frame, decode_choices=False)
    for field, value in zip(layout.fields, values, strict=True):
        assert scaled[field.name] == pytest.approx(value * field.scale, rel=1e-12, abs=1e-12)


@given(st.data(), ANY)
def test_the_code_reads_what_cantools_packs_but_for_the_checksum(data: st.DataObject, layout: Layout) -> None:
    values = data.draw(some_values(layout))
    message = LOADED.get_message_by_frame_id(layout.identifier)
    ours = layout.pack(9, *values)
    named = {field.name: value for field, value in zip(layout.fields, values, strict=True)}
    named |= {"counter": 9, "checksum": int.from_bytes(ours[-(1 if layout.size == 8 else 2) :], "little")}
    assert message.encode(named, scaling=False) == ours


def test_a_choice_has_its_name() -> None:
    frame = STATUS.pack(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 3, 5)
    decoded = LOADED.decode_message(STATUS.identifier, frame)
    assert isinstance(decoded, dict)
    assert (str(decoded["state"]), str(decoded["fault"])) == ("FAULT", "SENSOR_STUCK")
