"""The link without a bus, on a time that the tests make: what latches, and what is said then."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from rigkit.wire.layout import Layout
from stagectl.link.config import Link
from stagectl.link.conversation import Conversation
from stagectl.wire import messages, samples
from stagectl.wire.messages import Command, Fault, HostState, State


class Talk:
    """A conversation with a stage that is a method call away."""

    def __init__(self, form: str = "fd") -> None:
        self.events: list[tuple[str, Any]] = []
        self.now, self.counter = 50.0, 0
        self.conversation = Conversation(Link(form=form), lambda *event: self.events.append(event), self.now)

    def hear(self, layout: Layout, *values: int) -> None:
        self.conversation.take(layout.identifier, layout.pack(0, *values), self.now)

    def beat(self, state: State = State.FOLLOWING, fault: Fault = Fault.NONE) -> None:
        self.hear(messages.STAGE_HEARTBEAT, state, fault, 0)

    def measure(self, value: float = 1e-5, skip: int = 0) -> None:
        self.counter += 1 + skip
        data = samples.encode(messages.POSITION, self.counter, np.full((10, 3), value))
        self.conversation.take(messages.POSITION.identifier, data, self.now)

    def step(self, seconds: float) -> list[tuple[int, bytes]]:
        self.now += seconds
        self.conversation.watch(self.now)
        return self.conversation.give(self.now)

    def heartbeat(self) -> HostState:
        """Return what the host says next."""
        said = dict(self.step(messages.HEARTBEAT))[messages.HOST_HEARTBEAT.identifier]
        return HostState(messages.HOST_HEARTBEAT.unpack(said)[1][0])


def streaming() -> Talk:
    talk = Talk()
    talk.beat(State.HOLDING)
    talk.conversation.begin()
    talk.beat()
    talk.measure()
    talk.step(0.0)
    assert not talk.conversation.reason
    return talk


def hold_by_itself(talk: Talk) -> None:
    talk.beat(State.HOLDING)


def ask_too_much(talk: Talk) -> None:
    talk.conversation.outbox.ring.put(np.full((10, 3), 400e-6))
    talk.step(0.0)


@pytest.mark.parametrize(
    ("go_wrong", "reason"),
    [
        (lambda talk: talk.step(0.051), "the stage is silent for 0.051 s, must be <= 0.05 s"),
        (lambda talk: talk.beat(State.RAMPING, Fault.SENSOR_STUCK), "the stage reports SENSOR_STUCK"),
        (hold_by_itself, "the stage has stopped following by itself, it is HOLDING"),
        (lambda talk: talk.measure(skip=51), "51 blocks from the stage are lost in a row"),
        (lambda talk: talk.conversation.lose("the adapter has gone"), "the adapter has gone"),
        (ask_too_much, r"Reference: x is 0.0004 m in sample 0, must be within \+-0.00032767 m"),
    ],
)
def test_what_goes_wrong_latches_and_is_logged_and_said_to_the_stage(
    go_wrong: Callable[[Talk], None], reason: str
) -> None:
    talk = streaming()
    go_wrong(talk)
    talk.step(0.0)
    assert talk.conversation.state is HostState.FAULT
    with pytest.raises(AssertionError, match=reason):
        raise AssertionError(talk.conversation.reason)
    assert talk.events == [("link_fault", {"reason": talk.conversation.reason})]
    assert talk.heartbeat() is HostState.FAULT
    talk.conversation.outbox.ring.put(np.zeros((10, 3)))
    talk.beat()
    assert messages.REFERENCE.identifier not in dict(talk.step(0.001))
    assert talk.conversation.reason


def test_the_first_reason_is_kept() -> None:
    talk = streaming()
    talk.conversation.lose("the adapter has gone")
    talk.step(1.0)
    talk.conversation.latch("the stage is silent")
    assert talk.conversation.reason == "the adapter has gone"
    assert len(talk.events) == 1


def test_nothing_latches_while_the_stage_only_holds() -> None:
    talk = Talk()
    talk.beat(State.FAULT, Fault.CONTROLLER)
    talk.step(1.0)
    talk.conversation.lose("unplugged")
    assert (talk.conversation.reason, talk.events) == ("", [])


def test_the_host_beats_every_5_ms_and_sends_references_as_soon_as_there_are_ten() -> None:
    talk = streaming()
    beats, references = 0, 0
    for _ in range(100):
        talk.beat()
        talk.measure()
        talk.conversation.outbox.ring.put(np.full((7, 3), 1e-5))
        frames = [identifier for identifier, _ in talk.step(1e-3)]
        beats += frames.count(messages.HOST_HEARTBEAT.identifier)
        references += frames.count(messages.REFERENCE.identifier)
    assert beats in (19, 20, 21)
    assert references == 70


def test_commands_and_chunks_go_out_at_once() -> None:
    talk = Talk()
    talk.conversation.outbox.command(Command.START, 3, 0)
    talk.conversation.outbox.chunk(5, bytes(58))
    frames = talk.step(0.0)
    assert [identifier for identifier, _ in frames] == [0x010, 0x020, 0x200]
    assert messages.COMMAND.unpack(frames[1][1])[1] == (Command.START, 3, 0)


def test_lost_blocks_are_held_in_their_place_and_late_ones_left_out() -> None:
    talk = streaming()
    inbox, ring = talk.conversation.inbox, talk.conversation.inbox.rings["position"]
    ring.skip()
    talk.measure(2e-5)
    talk.measure(3e-5, skip=2)
    talk.counter -= 2
    talk.measure(9e-5)
    block = np.zeros((60, 3))
    assert ring.take(block) == 40
    np.testing.assert_allclose(block[:40:10, 0], [2e-5, 2e-5, 2e-5, 3e-5])
    assert (inbox.counts.lost, inbox.counts.late, inbox.counts.longest_gap) == (2, 1, 2)


def test_garbled_frames_are_counted_and_change_nothing() -> None:
    talk = streaming()
    before = talk.conversation.inbox.heard
    talk.now += 0.01
    frame = bytearray(messages.STAGE_HEARTBEAT.pack(0, State.FAULT, Fault.CONTROLLER, 0))
    frame[1] ^= 1
    talk.conversation.take(messages.STAGE_HEARTBEAT.identifier, bytes(frame), talk.now)
    talk.conversation.take(messages.POSITION.identifier, b"", talk.now)
    inbox = talk.conversation.inbox
    assert (inbox.counts.garbled, inbox.heard, inbox.state) == (2, before, State.FOLLOWING)


def test_the_stages_own_account_is_kept() -> None:
    talk = Talk()
    talk.hear(messages.STATUS, 1_500_000_000, 1500, 7, 1, 2, 3, 4, 99, 40, 123, State.HOLDING, Fault.NONE)
    status = talk.conversation.inbox.status
    assert status is not None
    assert (status.time, status.block, status.parameters, status.lost, status.underruns) == (1.5, 1500, 7, 1, 4)
    assert (status.reference, status.waiting, status.silence) == (99, 40, pytest.approx(0.0123))


def test_frames_of_the_host_and_of_strangers_are_passed_over() -> None:
    talk = Talk()
    talk.hear(messages.COMMAND, Command.STOP, 0, 0)
    talk.conversation.take(0x7FF, b"", talk.now)
    talk.conversation.take(messages.SLOW_POSITION.identifier, bytes(8), talk.now)
    counts = talk.conversation.inbox.counts
    assert (counts.garbled, counts.lost) == (0, 0)


def test_the_link_on_classic_can_sends_a_sample_a_millisecond() -> None:
    talk = Talk("classic")
    talk.conversation.begin()
    talk.beat()
    talk.conversation.outbox.ring.put(np.full((2, 3), 1e-5))
    frames = [identifier for identifier, data in talk.step(0.0) if len(data) == 8]
    assert frames.count(messages.SLOW_REFERENCE.identifier) == 2
