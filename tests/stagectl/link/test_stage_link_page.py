"""docs/stage-link.md says what the code says."""

import math
import re

import pytest

from firmware_sim.can_node import MISHAPS
from rigkit.wire.layout import Layout
from stagectl.wire import messages, samples
from stagectl.wire.bus_load import frame_time, least_load
from stagectl.wire.messages import LAYOUTS, Command, Fault, HostState, Result, State
from tests.contract.source_tree import ROOT

PAGE = (ROOT / "docs/stage-link.md").read_text()
ROWS = [[cell.strip() for cell in line.split("|")[1:-1]] for line in PAGE.splitlines() if line.startswith("| ")]
TYPES = {"B": "u8", "H": "u16", "I": "u32", "Q": "u64"}
RECORDS = [messages.HOST_HEARTBEAT, messages.STAGE_HEARTBEAT, messages.COMMAND, messages.REPLY]
RECORDS += [messages.STATUS, messages.LASER_STATUS]
BUSES = [row for row in ROWS if row[0] in ("fd", "classic")]


@pytest.mark.parametrize("layout", LAYOUTS, ids=lambda layout: layout.name)
def test_every_frame_has_its_row(layout: Layout) -> None:
    every = f"{1e3 * layout.period:g} ms" if math.isfinite(layout.period) else "-"
    head = [f"`{layout.name}`", f"0x{layout.identifier:03X}".replace("X", "x"), layout.sender, str(layout.size)]
    assert [*head, every, layout.purpose] in ROWS


@pytest.mark.parametrize("layout", RECORDS, ids=lambda layout: layout.name)
def test_every_field_is_listed_in_order(layout: Layout) -> None:
    fields = ", ".join(f"{field.name} {TYPES[field.kind]} {field.unit}".strip() for field in layout.fields)
    assert [f"`{layout.name}`", fields] in ROWS


def test_chunks_have_as_much_room_as_the_page_says() -> None:
    assert f"then {messages.LONG_DATA} bytes of the set, {messages.SHORT_DATA} in a short frame" in PAGE


def test_ranges_are_those_of_the_code() -> None:
    found = {name: row for row in ROWS for name in re.findall(r"`(\w+)`", row[0]) if len(row) == 4}
    for layout in (messages.REFERENCE, messages.POSITION, messages.ABSOLUTE, messages.EXTENSION, messages.VOLTAGE):
        _, count, span, _ = found[layout.name]
        field = layout.fields[0]
        assert count == f"{field.scale:g} {field.unit}"
        assert span == f"+-{samples.FULL_SCALE * field.scale:.7g} {field.unit}"


def test_every_state_fault_command_and_result_has_its_number() -> None:
    for choice in (*State, *Fault, *Command):
        assert any(row[0] == f"`{choice.name}` ({choice.value})" for row in ROWS), choice
    for choice in (*Result, *HostState):
        assert f"`{choice.name}` {choice.value}" in PAGE, choice


@pytest.mark.parametrize("row", BUSES, ids=lambda row: " ".join(row[:2]))
def test_times_on_the_bus_are_those_of_the_code(row: list[str]) -> None:
    form, rates, time, busy = row
    slow, fast = ([int(rate.replace(" ", "")) for rate in rates.split(",")] + [1_000_000])[:2]
    layout = messages.REFERENCE if form == "fd" else messages.SLOW_REFERENCE
    assert float(time) == pytest.approx(1e6 * frame_time(layout, slow, fast), abs=0.5)
    assert float(busy.rstrip("% ")) == pytest.approx(100 * least_load(form, slow, fast), abs=0.6)


def test_there_are_four_buses_and_every_mishap() -> None:
    assert len(BUSES) == 4
    assert all(f"`{mishap}`" in PAGE for mishap in MISHAPS)
    assert f"{1e3 * messages.SILENCE:g} ms" in PAGE
