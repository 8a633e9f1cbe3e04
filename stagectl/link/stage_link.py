"""The link to the stage: open it, start and stop the stage, ask it, and acknowledge what went wrong."""

import itertools
import random
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Self

import numpy as np

from rigkit.latch import to_clear
from rigkit.relay.heartbeat import Heartbeat
from rigkit.ring import Ring
from stagectl.link.account import Counts, Status
from stagectl.link.bus import LinkError
from stagectl.link.capture import Capture
from stagectl.link.carrier import Carrier
from stagectl.link.config import Link
from stagectl.link.conversation import Conversation
from stagectl.link.tell import Tell, nobody
from stagectl.wire.bus_load import excited_load
from stagectl.wire.messages import BLOCK, RATE, Command, Drive, Fault, HostState, Result, State

_AGAIN = 0.2
"""s after which a command without an answer is given again."""


class LinkFault(LinkError):
    """The link has latched: a person must find out why, and acknowledge."""


class StageLink:
    """The stage behind its bus: a context manager that holds the bus open, with the stage at mid-travel until `start`.

    Whatever goes wrong while the stage follows - adapter unplugged, stage silent, in fault or no longer following,
    frames lost for longer than `stall`, a reference out of range - latches: the heartbeat says so, which sends the
    stage to mid-travel, no reference goes out any more, the Blocks raise `LinkFault`, which stops their clock, and
    `reason` says why.  The adapter is opened again when it is back, but nothing starts again by itself: `acknowledge`,
    then `start`.

    Parameters
    ----------
    link : Link
    tell : callable(event, fields)
        Told of each fault and acknowledgement, for the run's log.
    now : callable() -> float, s, a monotonic clock

    Raises
    ------
    LinkError : on entry, when the bus cannot be opened or the stage is not heard.
    RelayError : on entry, when the bus to the relay cannot be opened.
    """

    def __init__(self, link: Link, tell: Tell = nobody, now: Callable[[], float] = time.monotonic) -> None:
        self.link = link
        self._tell, self._now = tell, now
        self._conversation = Conversation(link, tell, now())
        self._carrier = Carrier(link, self._conversation, now)
        self._relay = Heartbeat(link.relay, self._pulse)
        self._tokens = itertools.count(random.randrange(256))  # no two programs' first commands are the same

    def __enter__(self) -> Self:
        """Open the bus and wait until the stage is heard."""
        self._carrier.open()
        if not self._until(lambda: self._conversation.inbox.heard > -np.inf, self.link.patience):
            self._carrier.close()
            raise LinkError(f"the stage on {self.link.channel} has sent nothing within {self.link.patience:g} s")
        try:
            self._relay.start()
        except BaseException:
            self._carrier.close()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        """Let the stage go to mid-travel, and close the bus."""
        try:
            if self._conversation.state is HostState.STREAMING:
                self.stop()
        finally:
            self._relay.stop()
            self._carrier.close()

    @property
    def rate(self) -> float:
        """Samples/s on the wire."""
        return RATE if self.link.form == "fd" else RATE / BLOCK

    @property
    def frames(self) -> int:
        """Samples of a block."""
        return BLOCK if self.link.form == "fd" else 1

    @property
    def beat(self) -> str:
        """What the stage sends in time."""
        return "block from the stage"

    @property
    def patience(self) -> float:
        """Longest time without a block before it is given up, s."""
        return self.link.patience

    @property
    def reason(self) -> str:
        """What has latched, or nothing."""
        return self._conversation.reason

    @property
    def state(self) -> State:
        """What the stage does, as it said last."""
        return self._conversation.inbox.state

    @property
    def stage_fault(self) -> Fault:
        """Why the stage does not follow, as it said last."""
        return self._conversation.inbox.fault

    @property
    def status(self) -> Status | None:
        """The stage's own account of references and parameters; None until it comes, and on a classic bus."""
        return self._conversation.inbox.status

    @property
    def counts(self) -> Counts:
        """What became of the frames from the stage; lines that are no frame are garbled, too."""
        counts = self._conversation.inbox.counts
        garbled = counts.garbled + self._carrier.garbled
        return replace(counts, garbled=garbled)

    @property
    def beats(self) -> int:
        """Heartbeats that the relay's bus has taken."""
        return self._relay.sent

    @property
    def sent(self) -> int:
        """Blocks of references sent."""
        return self._conversation.outbox.sent

    @property
    def references(self) -> Ring:
        """Where references wait to be sent, m from mid-travel."""
        return self._conversation.outbox.ring

    def signal(self, name: str) -> tuple[Ring, np.ndarray]:
        """Return the samples of "position", "absolute" (m from mid-travel), "extension" (m), "voltage" (V).

        Both are live: arrays of shape (samples, 3) and (3,).
        """
        inbox = self._conversation.inbox
        if name not in inbox.rings:
            raise KeyError(f"no signal {name!r} comes from the stage; there are {', '.join(inbox.rings)}")
        return inbox.rings[name], inbox.newest[name]

    def start(self) -> None:
        """Let the stage follow the references, from mid-travel on; the first must come within its `stall`.

        Raises
        ------
        LinkFault : a fault is latched.
        LinkError : the stage does not answer, or is not at rest.
        """
        self._begin(Command.START, 0, None, None)

    def excite(self, drive: Drive, axis: int, capture: Capture) -> None:
        """Let the stage open the loop of an axis, for what `references` then holds: V or m from rest.

        Parameters
        ----------
        drive : Drive
        axis : int, counted from 0
        capture : Capture
            Gets every block from now until the stage is started again.

        Raises
        ------
        ValueError : the bus is too slow for it.
        LinkFault : a fault is latched.
        LinkError : the stage does not answer, is not at rest, or refuses.
        """
        load = excited_load(self.link.bitrate, self.link.data_bitrate) if self.link.form == "fd" else np.inf
        if not load <= 1:
            raise ValueError(
                f"link.form is {self.link.form}, {self.link.bitrate} and {self.link.data_bitrate} bit/s: the bus would "
                f"be busy for {100 * load:.0f} % of the time while an axis is excited, must be fd and <= 100 %"
            )
        if not self._until(lambda: self.state is State.HOLDING, self.link.patience):
            raise LinkError(f"the stage cannot be excited: it is {self.state.name}, must be {State.HOLDING.name}")
        self._begin(Command.EXCITE, 256 * drive + axis, drive, capture)

    def stop(self) -> None:
        """Let the stage go to mid-travel.

        Raises
        ------
        LinkError : the stage does not answer.
        """
        self._conversation.end()
        self.ask(Command.STOP, 0)

    def halt(self) -> None:
        """Let a stage that follows go to mid-travel, without waiting for its answer: from any thread."""
        if self._conversation.state is HostState.STREAMING:
            self._conversation.end()
            self._conversation.outbox.command(Command.STOP, next(self._tokens) % 256, 0)
            self.flush()

    def acknowledge(self, by: str) -> str:
        """End a fault, in the name of the person who found out why, and return what it was.

        Raises
        ------
        ValueError : nobody is named, or there is no fault.
        LinkError : the stage is not heard yet, or still on its way to mid-travel.
        """
        reason = self.reason or (self.stage_fault.name if self.stage_fault is not Fault.NONE else "")
        to_clear("the link to the stage", reason, by)
        if not self._is_heard:
            raise LinkError(f"{by} cannot acknowledge yet: the stage on {self.link.channel} sends nothing")
        if not self._until(lambda: self.state in (State.HOLDING, State.FAULT), self.link.patience):
            raise LinkError(f"{by} cannot acknowledge yet: the stage is {self.state.name}")
        result, _ = self.ask(Command.ACKNOWLEDGE, 0)
        if result is not Result.DONE or not self._until(lambda: self.stage_fault is Fault.NONE, self.link.patience):
            raise LinkError(f"{by} cannot acknowledge yet: {result.name}, the stage reports {self.stage_fault.name}")
        self._conversation.clear()
        self._tell("link_acknowledged", {"by": by, "reason": reason})
        return reason

    def refuse_when_latched(self) -> None:
        """Raise `LinkFault` while a fault is latched."""
        if self.reason:
            raise LinkFault(f"{self.reason}; a person must acknowledge")

    def skip(self) -> int:
        """Pass over the positions that wait; return how many samples have come in all, for `wait`."""
        ring = self._conversation.inbox.rings["position"]
        ring.skip()
        return ring.taken + ring.refused

    def wait(self, samples: int, seconds: float) -> bool:
        """Return True as soon as so many samples of position have come in all, False on a fault or after `seconds`."""
        ring = self._conversation.inbox.rings["position"]
        self._until(lambda: ring.offered >= samples or bool(self.reason), seconds)
        return ring.offered >= samples and not self.reason

    def flush(self) -> None:
        """Have what waits sent now, rather than within a millisecond."""
        self._carrier.flush()

    def ask(self, command: Command, argument: int) -> tuple[Result, int]:
        """Give the stage a command and return its answer; LinkError where there is none within `patience`."""
        token, replies = next(self._tokens) % 256, self._conversation.inbox.replies
        replies.clear()
        deadline = self._now() + self.link.patience
        while self._now() < deadline:
            self._conversation.outbox.command(command, token, argument)
            self.flush()
            self._until(lambda: any(reply[0] == token for reply in tuple(replies)), min(_AGAIN, self.link.patience))
            for _, result, about in (reply for reply in tuple(replies) if reply[0] == token):
                return Result(result), about
        raise LinkError(f"the stage on {self.link.channel} does not answer {command.name} in {self.link.patience:g} s")

    def write(self, pieces: list[tuple[int, bytes]]) -> None:
        """Send pieces of a parameter set."""
        for number, data in pieces:
            self._conversation.outbox.chunk(number, data)
        self.flush()

    def read(self, numbers: range) -> dict[int, bytes]:
        """Wait a moment for pieces of a parameter set that were asked for; return those that came, by number."""
        chunks = self._conversation.inbox.chunks
        self._until(lambda: all(number in chunks for number in numbers), _AGAIN)
        return {number: chunks.pop(number) for number in numbers if number in chunks}

    @property
    def _is_heard(self) -> bool:
        silence = self._now() - self._conversation.inbox.heard
        return self._carrier.is_up and silence <= max(self.link.stall, _AGAIN)

    def _pulse(self) -> int | None:
        """Return what moves on while all is well, for the relay: what the stage hears of this program."""
        is_well = self._is_heard and not self.reason and self.stage_fault is Fault.NONE
        return self._conversation.outbox.beats if is_well else None

    def _begin(self, command: Command, argument: int, drive: Drive | None, capture: Capture | None) -> None:
        self.refuse_when_latched()
        if self.stage_fault is not Fault.NONE:
            raise LinkFault(f"the stage reports {self.stage_fault.name}; a person must acknowledge")
        result, _ = self.ask(command, argument)
        if result is not Result.DONE:
            raise LinkError(f"the stage does not obey {command.name}: {result.name}, it is {self.state.name}")
        self._conversation.inbox.capture = capture
        self._conversation.begin(drive)
        self.flush()

    def _until(self, met: Callable[[], bool], seconds: float) -> bool:
        with self._carrier.arrived:
            return self._carrier.arrived.wait_for(met, seconds)
