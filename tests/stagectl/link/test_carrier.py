"""The thread that listens, with a bus and a time that the test makes."""

import can
import numpy as np

from stagectl.link.bus import message
from stagectl.link.carrier import Carrier
from stagectl.link.config import Link
from stagectl.link.conversation import Conversation
from stagectl.link.tell import nobody
from stagectl.wire import messages, samples
from stagectl.wire.messages import Fault, State


class Waiting:
    """A bus on which frames wait; when all are read it ends the thread."""

    def __init__(self, frames: list[can.Message]) -> None:
        self.frames = frames
        self.carrier: Carrier | None = None

    def recv(self, timeout: float) -> can.Message | None:
        if self.frames:
            return self.frames.pop(0)
        assert self.carrier is not None
        self.carrier._over.set()  # noqa: SLF001
        return None


class Closed(Waiting):
    """A bus that the other thread closes while this one reads."""

    def recv(self, timeout: float) -> can.Message | None:
        super().recv(timeout)
        assert self.carrier is not None
        self.carrier._bus = None  # noqa: SLF001
        raise TypeError("argument must be an int, or have a fileno() method.")


def listened(frames: list[can.Message], stall: float, kind: type[Waiting] = Waiting) -> Conversation:
    """Return a conversation that has been streaming, after a thread that stood still read what waits."""
    conversation, time = Conversation(Link(), nobody, 100.0), 100.0
    beat = messages.STAGE_HEARTBEAT.pack(0, State.FOLLOWING, Fault.NONE, 0)
    conversation.take(messages.STAGE_HEARTBEAT.identifier, beat, time)
    conversation.begin()
    bus = kind(frames)
    carrier = Carrier(Link(), conversation, lambda: time + stall)
    carrier._bus = bus  # noqa: SLF001
    bus.carrier = carrier
    carrier._listen()  # noqa: SLF001
    return conversation


POSITION = message(messages.POSITION.identifier, samples.encode(messages.POSITION, 0, np.zeros((10, 3))))
BEAT = message(messages.STAGE_HEARTBEAT.identifier, messages.STAGE_HEARTBEAT.pack(1, State.FOLLOWING, Fault.NONE, 0))


def test_a_host_that_stood_still_reads_what_waits_before_it_takes_the_stage_for_silent() -> None:
    assert listened([POSITION, BEAT, POSITION], stall=0.08).reason == ""


def test_a_stage_without_heartbeat_is_silent_whatever_else_it_sends() -> None:
    assert listened([POSITION, POSITION], stall=0.08).reason.startswith("the stage is silent for 0.08 s")


def test_a_port_that_the_other_thread_has_closed_is_no_reason_of_its_own() -> None:
    assert listened([], stall=0.0, kind=Closed).reason == ""
