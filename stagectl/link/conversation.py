"""What the host makes of all that comes and goes: the state of the link, and the fault that latches."""

from rigkit.wire.layout import WireError
from stagectl.link.account import Lasers
from stagectl.link.config import Link
from stagectl.link.inbox import Inbox
from stagectl.link.outbox import Outbox
from stagectl.link.tell import Tell
from stagectl.wire.messages import AXES, DRIVES, PERIOD, Drive, Fault, HostState, State


class Conversation:
    """The link without its bus and threads: frames are put in and taken out.

    Parameters
    ----------
    link : Link
    tell : callable(event, fields)
        Told of each fault, for the run's log.
    now : float, s, when the link is opened
    """

    def __init__(self, link: Link, tell: Tell, now: float) -> None:
        self.inbox, self.outbox = Inbox(link.form), Outbox(link.form)
        self.state, self.reason = HostState.IDLE, ""
        self._link, self._tell, self._opened = link, tell, now
        self._led, self._has_followed = State.FOLLOWING, False

    @property
    def due(self) -> float:
        """When `give` has something to send by itself, s."""
        return self.outbox.due

    def begin(self, drive: Drive | None = None) -> None:
        """Let references go out: the stage has answered START, or EXCITE of a `drive`."""
        self._led, self._has_followed = State.FOLLOWING if drive is None else State.EXCITED, False
        self.inbox.counts.lasers = Lasers()
        self.inbox.counts.longest_gap, self.inbox.counts.longest_silence = 0, 0.0
        self.outbox.stream = self.outbox.references if drive is None else DRIVES[drive]
        self.outbox.ring.skip()
        self.state = HostState.STREAMING

    def end(self) -> None:
        """Let no reference go out any more."""
        if not self.reason:
            self.state = HostState.IDLE

    def clear(self) -> None:
        """Forget the fault: a person has acknowledged."""
        self.reason, self.state = "", HostState.IDLE

    def take(self, identifier: int, data: bytes, now: float) -> None:
        """Take a frame from the bus."""
        self.inbox.take(identifier, data, now)

    def give(self, now: float) -> list[tuple[int, bytes]]:
        """Return identifier and data of the frames to send now."""
        try:
            return self.outbox.frames(self.state, now, now - self._opened)
        except WireError as fault:  # a reference that no frame can carry
            self.latch(str(fault))
            return []

    def watch(self, now: float) -> None:
        """Look whether the stage is still with us; only while it is to follow."""
        if self.state is not HostState.STREAMING:
            return
        inbox, silence = self.inbox, now - self.inbox.heard
        inbox.counts.longest_silence = max(inbox.counts.longest_silence, silence)
        self._has_followed |= inbox.state is self._led
        if not silence <= self._link.stall:
            self.latch(f"the stage is silent for {silence:.3g} s, must be <= {self._link.stall:g} s")
        elif inbox.fault is not Fault.NONE:
            axis = inbox.counts.lasers.axis
            self.latch(f"the stage reports {inbox.fault.name}" + (f", the laser on {AXES[axis - 1]}" if axis else ""))
        elif self._has_followed and inbox.state is not self._led:
            self.latch(f"the stage has stopped following by itself, it is {inbox.state.name}")
        elif inbox.counts.longest_gap * PERIOD > self._link.stall:
            self.latch(f"{inbox.counts.longest_gap} blocks from the stage are lost in a row")

    def lose(self, reason: str) -> None:
        """Hear that the adapter has gone."""
        self.inbox.rejoin()
        if self.state is HostState.STREAMING:
            self.latch(reason)

    def latch(self, reason: str) -> None:
        """Keep the first reason, and say FAULT to the stage with the next heartbeat, which is due at once."""
        if not self.reason:
            self.reason, self.state = reason, HostState.FAULT
            self.outbox.due = 0.0
            self._tell("link_fault", {"reason": reason})
