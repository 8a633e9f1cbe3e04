"""Frames to a relay: they come while a count moves on, and for no other reason."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import can
import cantools
import pytest
from cantools.database.can import Database
from pydantic import ValidationError

import rigkit.relay
from rigkit.relay.bus import RelayError
from rigkit.relay.config import Relay
from rigkit.relay.frame import IDENTIFIER, dbc_text
from rigkit.relay.heartbeat import Heartbeat
from tests.rigkit.relay.listening import behind_an_adapter, on_a_port, on_the_virtual_bus, virtual
from tests.until import until

FILE = Path(rigkit.relay.__file__).parent / "relay.dbc"


class Program:
    """What a relay is to know of: a count that moves on each time it is looked at, as long as all is well."""

    def __init__(self) -> None:
        self.looks, self.count = 0, 0
        self.stands_still = self.is_latched = False

    def pulse(self) -> int | None:
        self.looks += 1
        self.count += not self.stands_still
        return None if self.is_latched else self.count

    def looked_at(self, times: int) -> None:
        """Return when the heartbeat has looked so many times more."""
        before = self.looks
        until(lambda: self.looks >= before + times)


@contextmanager
def beating(program: Program, **settings: Any) -> Iterator[Heartbeat]:
    made = Heartbeat(Relay(**settings), program.pulse)
    made.start()
    try:
        yield made
    finally:
        made.stop()


def test_while_all_is_well_frames_come_that_any_tool_decodes_and_their_counter_moves_on() -> None:
    database = cantools.database.load_file(FILE)
    assert isinstance(database, Database)
    with can.Bus(interface="virtual", channel="well") as bus, beating(Program(), **virtual("well")):
        received = [bus.recv(20.0) for _ in range(5)]
    frames = [message for message in received if message is not None]
    assert [message.arbitration_id for message in frames] == [IDENTIFIER] * 5
    told: list[Any] = [database.decode_message(IDENTIFIER, bytes(message.data)) for message in frames]
    assert [frame["counter"] for frame in told] == [0, 1, 2, 3, 4]
    times = [frame["time"] for frame in told]
    assert times == sorted(times)


def test_the_description_of_the_frame_is_the_one_the_code_writes() -> None:
    """`make docs` writes it."""
    assert FILE.read_text() == dbc_text()


@pytest.mark.sample(1)
@pytest.mark.parametrize("how", ["stands_still", "is_latched"])
def test_a_program_that_is_not_well_is_silent_at_once_and_beats_again_afterwards(how: str) -> None:
    program = Program()
    with on_the_virtual_bus(how) as heard, beating(program, **virtual(how)) as heart:
        heard.until(closed=True)
        setattr(program, how, True)
        program.looked_at(2)
        sent = heart.sent
        program.looked_at(10)
        assert heart.sent == sent
        heard.until(closed=False)
        setattr(program, how, False)
        heard.until(closed=True)
        heart.stop()
        heard.until(closed=False)


def test_a_count_that_has_moved_only_while_the_guard_was_latched_is_no_beat() -> None:
    counts = [5, 5, None, None, 9, 9, 9]
    seen: list[int | None] = []

    def pulse() -> int | None:
        seen.append(counts[min(len(seen), len(counts) - 1)])
        return seen[-1]

    heart = Heartbeat(Relay(**virtual("moved")), pulse)
    heart.start()
    until(lambda: len(seen) > len(counts))
    heart.stop()
    assert heart.sent == 0


def test_an_adapter_that_goes_is_silence_and_one_that_is_back_is_used(tmp_path: Path) -> None:
    with behind_an_adapter(tmp_path) as (heard, plug), beating(Program(), **on_a_port(tmp_path)) as heart:
        heard.until(closed=True)
        plug.unplug()
        heard.until(closed=False)
        sent = heart.sent
        plug.plug()
        heard.until(closed=True)
        assert heart.sent > sent


def test_what_others_send_is_passed_over() -> None:
    with can.Bus(interface="virtual", channel="others") as bus, beating(Program(), **virtual("others")) as heart:
        for number in range(1_000):
            bus.send(can.Message(arbitration_id=0x123, data=[number % 256], is_extended_id=False))
        until(lambda: heart.sent > 20)


def test_without_a_bus_there_is_no_thread() -> None:
    threads = threading.active_count()
    with beating(Program()) as heart:
        assert threading.active_count() == threads
    assert heart.sent == 0


@pytest.mark.parametrize(
    ("settings", "fault", "why"),
    [
        ({"bus": "can:Bus", "channel": "can77", "options": {"interface": "socketcan"}}, RelayError, "'can77'"),
        ({"bus": "can:Bus", "options": {"interface": "nonesuch"}}, RelayError, "nonesuch"),
        ({"bus": "can:Bus", "channel": "/nowhere", "options": {"interface": "slcan"}}, RelayError, "'/nowhere'"),
        ({"bus": "can:Buss"}, ValueError, "relay.bus, can:Buss: module can has no Buss; did you mean Bus"),
        ({"bus": "cann:Bus"}, ValueError, "there is no module cann"),
    ],
)
def test_a_bus_that_cannot_be_opened_is_refused_in_one_line(
    settings: dict[str, Any], fault: type[Exception], why: str
) -> None:
    heart, threads = Heartbeat(Relay(**settings), lambda: 0), threading.active_count()
    with pytest.raises(fault, match=why) as refused:
        heart.start()
    assert "\n" not in str(refused.value)
    assert threading.active_count() == threads


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("identifier", -1),
        ("identifier", 0x800),
        ("identifier", 1.5),
        ("period", 0.009),
        ("period", 1.1),
        ("period", float("nan")),
        ("channel", ""),
        ("bus", "can.Bus"),
        ("bus", "can:Bus; import os"),
        ("options", "interface=slcan"),
        ("patience", 1.0),
    ],
)
def test_settings_out_of_their_range_are_refused(name: str, value: Any) -> None:
    with pytest.raises(ValidationError, match=name):
        Relay(**{name: value})
