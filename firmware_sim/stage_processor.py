"""The stage's signal processor as the wire shows it: follows references, watches the host, holds when in doubt."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from firmware_sim.parameter_store import ParameterStore
from firmware_sim.reference_queue import ReferenceQueue
from firmware_sim.reference_stream import ReferenceStream
from firmware_sim.slcan_adapter import Frame
from firmware_sim.stage_frames import Signals, StageFrames
from rigkit.wire.layout import GarbledError, Layout, WireError
from stagectl.wire import messages
from stagectl.wire.messages import PERIOD, Command, Drive, Fault, HostState, Result, State

Tick = Callable[[np.ndarray], Signals]
"""From references, shape (10, 3), m from mid-travel (excited: V or m from rest), to "position" and "extension" (m) and
"voltage" (V) of that shape, "absolute" (m) and "laser" where lasers are read, and the "fault" that has latched."""


def _nothing(*_: object) -> None:
    """Do nothing."""


def _refuse(*_: object) -> None:
    raise ValueError("these loops cannot be excited")


@dataclass(frozen=True)
class Loops:
    """What the processor runs.

    Parameters
    ----------
    tick : callable, see `Tick`
    commit : callable(mapping of str to array)
        Puts parameters into use between two ticks; a ValueError refuses them.
    clear : callable()
        Clears the loops' own latch: a person has acknowledged.
    excite : callable(Drive, int)
        Takes all axes to rest and opens the loop of one, counted from 0, so that what comes drives it; a ValueError
        refuses.
    release : callable()
        Takes them to rest again and closes the loops.
    follow, leave : callable()
        The stage begins to follow references, and ceases to.
    """

    tick: Tick
    commit: Callable[[Mapping[str, np.ndarray]], None] = _nothing
    clear: Callable[[], None] = _nothing
    excite: Callable[[Drive, int], None] = _refuse
    release: Callable[[], None] = _nothing
    follow: Callable[[], None] = _nothing
    leave: Callable[[], None] = _nothing


@dataclass(frozen=True)
class Settings:
    """How a stage is built.

    Parameters
    ----------
    form : "fd" or "classic"
        Ten samples a frame, or one in ten.
    pace : "own" or "host"
        A block each millisecond of its own crystal; or, while it follows, one for each reference, however fast they
        come.
    silence : float, s without the host's heartbeat that is a fault
    hold : float, s beyond `silence` for which the last reference is held before its absence is a fault
    ramp : float, s from anywhere to mid-travel
    ahead : int, blocks of references that wait before they are followed
    others_every : int, blocks from one extension and voltage to the next; 0 for none
    behind : float, s of its own time that the processor catches up with; more is an overrun
    """

    form: Literal["fd", "classic"] = "fd"
    pace: Literal["own", "host"] = "own"
    silence: float = messages.SILENCE
    hold: float = messages.HOLD
    ramp: float = 0.1
    ahead: int = 2
    others_every: int = 10
    behind: float = 0.5


_CHUNKS = (messages.WRITE_CHUNK, messages.SLOW_WRITE_CHUNK)
_LED = (State.FOLLOWING, State.EXCITED)
"""States in which the host streams."""
_AT_ONCE = 10
"""Blocks it catches up with before it looks at the wire again."""
_REMEMBERED = 1.0
"""s, at least, for which a command that comes again is the same one, asked again."""
_LONGEST_TOLD = 0xFFFF
"""Of the silence in the status, 0.1 ms."""


class StageProcessor:
    """The state machine of docs/stage-link.md.  It has no clock and no wire: both are given to it.

    Parameters
    ----------
    loops : Loops
    settings : Settings
    now : float, s, when it is switched on
    """

    def __init__(self, loops: Loops, settings: Settings, now: float) -> None:
        self.state, self.fault = State.HOLDING, Fault.NONE
        self.block = self.garbled = 0
        self._loops, self._settings = loops, settings
        self._queue = ReferenceQueue(settings.ahead if settings.pace == "own" else 1)
        self._store = ParameterStore(loops.commit)
        self._references = messages.REFERENCE if settings.form == "fd" else messages.SLOW_REFERENCE
        self._stream = ReferenceStream(self._references, self._queue, settings.silence + settings.hold)
        self._due = self._host = now
        self._longest_gap = 0.0
        self._answered: tuple[int, ...] = ()
        self._answer_given: tuple[int, ...] = ()
        self._answered_at = now
        self.frames = StageFrames(settings.form, settings.others_every, now)

    @property
    def due(self) -> float:
        """When `advance` has something to do by itself, s."""
        return min(self._due, self.frames.beat_due)

    def receive(self, frame: Frame, now: float) -> None:
        """Take a frame from the bus."""
        layout = messages.BY_IDENTIFIER.get(frame.identifier)
        if layout is None or layout.sender != "host":
            return
        try:
            if layout is self._stream.layout:
                self._take_reference(frame.data, now)
                return
            _, values = layout.unpack(frame.data)
        except GarbledError:
            self.garbled += 1
            self._stream.garble()
            return
        if layout is messages.HOST_HEARTBEAT:
            gap, self._host = now - self._host, now
            if self.state in _LED:
                self._longest_gap = max(self._longest_gap, gap)
            if values[0] == HostState.FAULT and self.state in _LED:
                self._fail(Fault.HOST_FAULT)
        elif layout in _CHUNKS:
            self._store.write(values[0], bytes(values[1:]))
        elif layout is messages.COMMAND:
            self._answer(values, now)

    def advance(self, now: float) -> list[Frame]:
        """Run the blocks that are due and return the frames to send."""
        self._watch(now)
        if self._settings.pace == "host" and self.state in _LED and self._stream.has_come:
            while len(self._queue) and self.state in _LED:
                self._run_block()
            self._due = now + PERIOD
        else:
            if now - self._due > self._settings.behind:
                self._due = now
                if self.state in _LED and self._settings.pace == "own":
                    self._fail(Fault.OVERRUN)
            last = self.block + _AT_ONCE
            while self._due <= now and self.block < last:
                self._run_block()
                self._due += PERIOD
        self.frames.beat(now, self.state, self.fault, self._account)
        return self.frames.take()

    def _watch(self, now: float) -> None:
        if self.state not in _LED:
            return
        fault = Fault.HOST_SILENT if now - self._host > self._settings.silence else self._stream.fault(now)
        if fault is not Fault.NONE:
            self._fail(fault)

    def _fail(self, fault: Fault) -> None:
        """Keep the first fault and go to mid-travel."""
        if self.fault is Fault.NONE:
            self.fault = fault
            self._retreat()

    def _retreat(self) -> None:
        self.state = State.RAMPING
        self._loops.leave()
        self._queue.retreat(self._settings.ramp)

    def _run_block(self) -> None:
        if self.state is State.RAMPING and not len(self._queue):
            self._queue.clear(self._settings.ahead)
            self._loops.release()
            self.frames.shows_all = False
            self.state = State.HOLDING if self.fault is Fault.NONE else State.FAULT
        try:
            signals = self._loops.tick(self._queue.take())
            self.frames.publish(self.block, signals)
            fault = Fault(signals.get("fault", Fault.NONE))
        except (WireError, ArithmeticError, ValueError):
            fault = Fault.CONTROLLER
        self.block += 1
        if fault is not Fault.NONE:
            self._fail(fault)

    def _account(self) -> tuple[int, ...]:
        """Return the fields of the status."""
        queue = self._queue
        counts = (queue.lost, queue.late, self.garbled, queue.underruns)
        waiting = len(queue) if self.state in _LED else 0
        silence = round(1e4 * max(self._longest_gap, self._stream.longest_gap))
        return self.block, self._store.in_use, *counts, self._stream.counter, waiting, min(silence, _LONGEST_TOLD)

    def _take_reference(self, data: bytes, now: float) -> None:
        if self.state in _LED and (fault := self._stream.take(data, now)) is not Fault.NONE:
            self._fail(fault)

    def _answer(self, values: tuple[int, ...], now: float) -> None:
        command, token, argument = values
        remembered = max(_REMEMBERED, self._settings.silence)
        if values != self._answered or now - self._answered_at > remembered:  # else its reply was lost, and comes again
            result, about = self._obey(Command(command), argument, now)
            self._answered, self._answer_given = values, (token, result, about)
        self._answered_at = now
        self.frames.send(messages.REPLY, *self._answer_given)

    def _obey(self, command: Command, argument: int, now: float) -> tuple[Result, int]:
        store, result, about = self._store, Result.DONE, 0
        if command is Command.START:
            result = self._start(self._references, self._settings.ahead, State.FOLLOWING, now)
        elif command is Command.EXCITE:
            result = self._excite(argument, now)
        elif command is Command.STOP:
            if self.state in _LED:
                self._retreat()
        elif command is Command.ACKNOWLEDGE:
            result = self._acknowledge()
        elif command is Command.BEGIN:
            result = store.begin(argument)
        elif command is Command.CHECK:
            about = store.received
        elif command is Command.READ:
            self.frames.send_back(store.read(argument))
        else:
            result = store.commit(argument)
        return result, about

    def _start(self, layout: Layout, ahead: int, led: State, now: float) -> Result:
        if self.state is not State.HOLDING or self.fault is not Fault.NONE:
            return Result.WRONG_STATE
        self._stream.begin(layout, ahead if self._settings.pace == "own" else 1, now)
        self._host, self._longest_gap = now, 0.0
        self.state = led
        if led is State.FOLLOWING:
            self._loops.follow()
        return Result.DONE

    def _excite(self, argument: int, now: float) -> Result:
        """Let an axis be excited; so much waits before it begins that a wait that is no fault is not heard in it."""
        if self.state is not State.HOLDING or self.fault is not Fault.NONE:
            return Result.WRONG_STATE
        try:
            if self._settings.form != "fd":
                raise ValueError("one sample in ten excites nothing")
            drive = Drive(argument // 256)
            self._loops.excite(drive, argument % 256)
        except ValueError:
            return Result.REFUSED
        self.frames.shows_all = True
        ahead = round(min(2 * (self._settings.silence + self._settings.hold), messages.LONGEST_AHEAD) / PERIOD)
        return self._start(messages.DRIVES[drive], ahead, State.EXCITED, now)

    def _acknowledge(self) -> Result:
        if self.state is not State.FAULT:
            return Result.WRONG_STATE if self.fault is not Fault.NONE else Result.DONE
        try:
            self._loops.clear()
        except ValueError:
            return Result.WRONG_STATE
        self.state, self.fault = State.HOLDING, Fault.NONE
        return Result.DONE
