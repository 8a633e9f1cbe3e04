"""The simulated adapter: python-can's own slcan is the foreign peer, and nothing a host does can stop it."""

import os
import select
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import can
import pytest

from firmware_sim.slcan_adapter import BUFFER, Frame, SlcanAdapter
from tests.until import EVER

LONG = bytes(range(64))


@pytest.fixture
def adapter(tmp_path: Path) -> Iterator[SlcanAdapter]:
    made = SlcanAdapter(tmp_path / "adapter")
    yield made
    made.unplug()


def opened(adapter: SlcanAdapter, **options: Any) -> can.BusABC:
    return can.Bus(interface="slcan", channel=adapter.path, sleep_after_open=0, **options)


def all_of(adapter: SlcanAdapter, count: int) -> list[Frame]:
    frames: list[Frame] = []
    for _ in range(100):
        adapter.wait(0.1)
        frames += adapter.received()
        if len(frames) >= count:
            break
    return frames


@pytest.mark.parametrize("frame", [Frame(0x101, LONG, True), Frame(0x011, b"12345678", False), Frame(1, b"", False)])
def test_python_cans_own_bus_sends_and_receives_frames(adapter: SlcanAdapter, frame: Frame) -> None:
    timing = can.BitTimingFd.from_sample_point(80_000_000, 1_000_000, 80.0, 5_000_000, 80.0)
    with opened(adapter, timing=timing) as bus:
        bus.send(
            can.Message(
                arbitration_id=frame.identifier,
                data=frame.data,
                is_fd=frame.is_fd,
                bitrate_switch=frame.is_fd,
                is_extended_id=False,
            )
        )
        assert all_of(adapter, 1) == [frame]
        adapter.send(frame)
        heard = next(message for message in iter(lambda: bus.recv(1.0), None) if message is not None)
    assert (heard.arbitration_id, bytes(heard.data), heard.is_fd) == (frame.identifier, frame.data, frame.is_fd)
    assert (adapter.refused, adapter.dropped) == (0, 0)


def test_versions_are_told(adapter: SlcanAdapter) -> None:
    host = os.open(adapter.path, os.O_RDWR | os.O_NOCTTY)
    os.write(host, b"V\rN\rF\rS8\r\r")
    adapter.wait(1.0)
    list(adapter.received())
    said = b""
    while said.count(b"\r") < 5:
        assert select.select([host], [], [], EVER)[0]
        said += os.read(host, 100)
    assert said == b"V1013\rN0001\rF00\r\r\r"
    os.close(host)


@pytest.mark.parametrize("line", [b"t0118", b"t01181122", b"b101F00", b"x", b"b101Gzz", b"\xff\xfe", b"?"])
def test_a_line_that_is_no_frame_is_refused_and_the_next_one_taken(adapter: SlcanAdapter, line: bytes) -> None:
    host = os.open(adapter.path, os.O_RDWR | os.O_NOCTTY)
    os.write(host, b"O\r" + line + b"\rt0012AABB\r")
    assert all_of(adapter, 1) == [Frame(1, b"\xaa\xbb", False)]
    assert adapter.refused == 1
    os.close(host)


def test_nothing_is_taken_or_given_while_the_channel_is_closed(adapter: SlcanAdapter) -> None:
    host = os.open(adapter.path, os.O_RDWR | os.O_NOCTTY)
    os.write(host, b"t0012AABB\r")
    adapter.wait(EVER)
    assert list(adapter.received()) == []
    adapter.send(Frame(1, b"", False))
    assert os.read(host, 100) == b"\a"
    os.close(host)


def test_a_host_that_never_reads_cannot_block_the_adapter(adapter: SlcanAdapter) -> None:
    host = os.open(adapter.path, os.O_RDWR | os.O_NOCTTY)
    os.write(host, b"O\r")
    all_of(adapter, 0)
    for _ in range(5000):
        adapter.send(Frame(0x101, LONG, True))
    assert 5000 - (BUFFER + 65_536) // 134 - 1 < adapter.dropped < 5000
    os.write(host, b"t0012AABB\r")
    assert all_of(adapter, 1) == [Frame(1, b"\xaa\xbb", False)]
    os.close(host)


def test_unplugged_it_hangs_up_and_is_gone_and_plugged_in_it_is_back_under_its_name(adapter: SlcanAdapter) -> None:
    bus = opened(adapter, bitrate=500_000)
    adapter.unplug()
    assert not Path(adapter.path).exists()
    with pytest.raises(can.CanOperationError):
        bus.recv(1.0)
    with suppress(can.CanOperationError):
        bus.shutdown()
    adapter.plug()
    with opened(adapter, bitrate=500_000):
        while not adapter.is_open:
            adapter.wait(EVER)
            assert list(adapter.received()) == []


def test_without_a_name_it_is_where_the_pseudo_terminal_is() -> None:
    adapter = SlcanAdapter()
    assert adapter.path.startswith("/dev/")
    adapter.unplug()
    with pytest.raises(FileNotFoundError, match="unplugged"):
        adapter.path  # noqa: B018 (the property raises)
    assert list(adapter.received()) == []
