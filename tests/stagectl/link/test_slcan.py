"""Our slcan bus against python-can's own: the same frames, faster, and not stopped by garbage."""

import os
import select
import time
from collections.abc import Iterator
from contextlib import suppress
from itertools import count
from pathlib import Path

import can
import pytest

from firmware_sim.slcan_adapter import Frame, SlcanAdapter
from stagectl.link.slcan import SlcanBus

Ends = tuple[SlcanAdapter, SlcanBus]
FRAMES = [Frame(0x101, bytes(range(64)), True), Frame(0x011, b"12345678", False), Frame(0x7FF, b"", False)]


@pytest.fixture
def ends(tmp_path: Path) -> Iterator[Ends]:
    adapter = SlcanAdapter(tmp_path / "adapter")
    with SlcanBus(channel=adapter.path, bitrate=1_000_000, sleep_after_open=0) as bus:
        while not adapter.is_open:
            adapter.wait(1.0)
            list(adapter.received())
        yield adapter, bus
    adapter.unplug()


def heard(bus: can.BusABC, count: int) -> list[Frame]:
    found: list[Frame] = []
    while len(found) < count:
        message = bus.recv(5.0)
        assert message is not None
        found.append(Frame(message.arbitration_id, bytes(message.data), message.is_fd))
    return found


def test_it_is_python_cans_bus(ends: Ends) -> None:
    assert isinstance(ends[1], can.BusABC)


def test_many_frames_that_came_at_once_are_given_one_by_one(ends: Ends) -> None:
    adapter, bus = ends
    for frame in FRAMES * 5:
        adapter.send(frame)
    assert heard(bus, 15) == FRAMES * 5
    assert (bus.recv(0.0), bus.garbled) == (None, 0)


def test_a_clock_that_is_set_back_is_not_waited_for(ends: Ends, monkeypatch: pytest.MonkeyPatch) -> None:
    hours = count(0, -3600.0)
    monkeypatch.setattr("can.bus.time", lambda: next(hours))
    begin = time.monotonic()
    assert ends[1].recv(0.01) is None
    assert ends[1].recv(0.0) is None
    assert time.monotonic() - begin < 600.0  # and not the hour


def test_a_frame_that_comes_in_two_parts_is_put_together(ends: Ends) -> None:
    adapter, bus = ends
    adapter.spill(b"t0118313233")
    assert bus.recv(0.05) is None
    adapter.spill(b"3435363738\r")
    assert heard(bus, 1) == [FRAMES[1]]


@pytest.mark.parametrize(
    "noise", [b"\xff\xfe\r", b"t0118zz\r", b"t01\r", b"b101F00\r", b"?\r", b"x" * 500 + b"\r", b"T0001\r", b"t0119\r"]
)
def test_garbage_is_counted_and_the_next_frame_taken(ends: Ends, noise: bytes) -> None:
    adapter, bus = ends
    adapter.spill(noise)
    adapter.send(FRAMES[0])
    assert heard(bus, 1) == [FRAMES[0]]
    assert bus.garbled >= 1


def test_an_adapter_that_has_stopped_to_read_cannot_be_opened_but_says_so(tmp_path: Path) -> None:
    adapter = SlcanAdapter(tmp_path / "adapter")
    host = os.open(adapter.path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    while select.select([], [host], [], 0.3)[1]:  # the system takes some on after it was full at first
        with suppress(BlockingIOError):
            os.write(host, bytes(1000))
    with pytest.raises(can.CanInitializationError):
        SlcanBus(channel=adapter.path, bitrate=1_000_000, sleep_after_open=0)
    os.close(host)
    adapter.unplug()


def test_answers_of_the_adapter_are_no_frames(ends: Ends) -> None:
    adapter, bus = ends
    bus.send(can.Message(arbitration_id=1, data=b"1", is_extended_id=False))
    os.write(bus.fileno(), b"V\rN\rF\r")
    select.select([bus.fileno()], [], [], 1.0)
    adapter.wait(1.0)
    list(adapter.received())
    adapter.spill(b"Z\rr0012\r")
    adapter.send(FRAMES[2])
    assert heard(bus, 1) == [FRAMES[2]]
    assert bus.garbled == 0


def test_an_extended_identifier_is_kept(ends: Ends) -> None:
    adapter, bus = ends
    adapter.spill(b"B0000010112233\rB0000010121122\r")
    message = bus.recv(5.0)
    assert message is not None
    assert (message.arbitration_id, message.is_extended_id, message.bitrate_switch) == (0x101, True, True)
    assert (bytes(message.data), bus.garbled) == (b"\x11\x22", 1)
