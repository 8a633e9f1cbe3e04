"""The stage's signal processor as the wire shows it: follows references, watches the host, holds when in doubt."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from firmware_sim.parameter_store import ParameterStore
from firmware_sim.reference_queue import ReferenceQueue
from firmware_sim.slcan_adapter import Frame
from firmware_sim.stage_frames import Signals, StageFrames
from stagectl.wire import messages, samples
from stagectl.wire.layout import GarbledError, WireError
from stagectl.wire.messages import PERIOD, Command, Fault, HostState, Result, State
from stagectl.wire.sequence import Sequence

Tick = Callable[[np.ndarray], Signals]
"""From references, shape (10, 3), m from mid-travel, to "position" and "extension" (m) and "voltage" (V) of that shape
and, where the loops have latched, the "fault"."""


def _nothing(*_: object) -> None:
    """Do nothing."""


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
    """

    tick: Tick
    commit: Callable[[Mapping[str, np.ndarray]], None] = _nothing
    clear: Callable[[], None] = _nothing


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
    silence : float, s without host or reference that is a fault
    ramp : float, s from anywhere to mid-travel
    ahead : int, blocks of references that wait before they are followed
    others_every : int, blocks from one extension and voltage to the next; 0 for none
    """

    form: Literal["fd", "classic"] = "fd"
    pace: Literal["own", "host"] = "own"
    silence: float = messages.SILENCE
    ramp: float = 0.1
    ahead: int = 2
    others_every: int = 10


_CHUNKS = (messages.WRITE_CHUNK, messages.SLOW_WRITE_CHUNK)
_AT_ONCE = 10
"""Blocks it catches up with before it looks at the wire again."""
_REMEMBERED = 1.0
"""s for which a command that comes again is the same one, asked again."""
_PATIENCE = 0.5
"""s of its own time the processor catches up with; more is an overrun."""


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
        self._expected = messages.REFERENCE if settings.form == "fd" else messages.SLOW_REFERENCE
        self._references = Sequence(self._expected.modulus)
        self._due = self._host = self._reference = now
        self._garbled_since = self._reference_counter = 0
        self._has_reference = False
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
            if layout is self._expected:
                self._take_reference(frame.data, now)
                return
            _, values = layout.unpack(frame.data)
        except GarbledError:
            self.garbled += 1
            self._garbled_since += 1
            return
        if layout is messages.HOST_HEARTBEAT:
            self._host = now
            if values[0] == HostState.FAULT and self.state is State.FOLLOWING:
                self._fail(Fault.HOST_FAULT)
        elif layout in _CHUNKS:
            self._store.write(values[0], bytes(values[1:]))
        elif layout is messages.COMMAND:
            self._answer(values, now)

    def advance(self, now: float) -> list[Frame]:
        """Run the blocks that are due and return the frames to send."""
        self._watch(now)
        if self._settings.pace == "host" and self.state is State.FOLLOWING and self._has_reference:
            while len(self._queue) and self.state is State.FOLLOWING:
                self._run_block()
            self._due = now + PERIOD
        else:
            if now - self._due > _PATIENCE:
                self._due = now
                if self.state is State.FOLLOWING:
                    self._fail(Fault.OVERRUN)
            last = self.block + _AT_ONCE
            while self._due <= now and self.block < last:
                self._run_block()
                self._due += PERIOD
        self.frames.beat(now, self.state, self.fault, self._account)
        return self.frames.take()

    def _watch(self, now: float) -> None:
        if self.state is not State.FOLLOWING:
            return
        if now - self._host > self._settings.silence:
            self._fail(Fault.HOST_SILENT)
        elif now - self._reference > self._settings.silence:
            self._fail(Fault.REFERENCE_GARBLED if self._garbled_since else Fault.REFERENCE_SILENT)

    def _fail(self, fault: Fault) -> None:
        """Keep the first fault and go to mid-travel."""
        if self.fault is Fault.NONE:
            self.fault = fault
            self._retreat()

    def _retreat(self) -> None:
        self.state = State.RAMPING
        self._queue.retreat(self._settings.ramp)

    def _run_block(self) -> None:
        if self.state is State.RAMPING and not len(self._queue):
            self._queue.clear()
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
        return self.block, self._store.in_use, *counts, self._reference_counter

    def _take_reference(self, data: bytes, now: float) -> None:
        counter, block = samples.decode(self._expected, data)
        if self.state is not State.FOLLOWING:
            return
        missing = self._references.accept(counter)
        if missing < 0:
            self._queue.late += 1
            return
        self._reference, self._garbled_since, self._reference_counter = now, 0, counter
        if missing * PERIOD >= self._settings.silence:
            self._fail(Fault.REFERENCE_SILENT)
        else:
            self._queue.put(missing, block)
            self._has_reference = True

    def _answer(self, values: tuple[int, ...], now: float) -> None:
        command, token, argument = values
        if values != self._answered or now - self._answered_at > _REMEMBERED:  # else its reply was lost
            result, about = self._obey(Command(command), argument, now)
            self._answered, self._answered_at, self._answer_given = values, now, (token, result, about)
        self.frames.send(messages.REPLY, *self._answer_given)

    def _obey(self, command: Command, argument: int, now: float) -> tuple[Result, int]:
        store, result, about = self._store, Result.DONE, 0
        if command is Command.START:
            result = self._start(now)
        elif command is Command.STOP:
            if self.state is State.FOLLOWING:
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

    def _start(self, now: float) -> Result:
        if self.state is not State.HOLDING or self.fault is not Fault.NONE:
            return Result.WRONG_STATE
        self._queue.clear()
        self._references.reset()
        self._garbled_since, self._has_reference = 0, False
        self._host = self._reference = now
        self.state = State.FOLLOWING
        return Result.DONE

    def _acknowledge(self) -> Result:
        if self.state is not State.FAULT:
            return Result.WRONG_STATE if self.fault is not Fault.NONE else Result.DONE
        try:
            self._loops.clear()
        except ValueError:
            return Result.WRONG_STATE
        self.state, self.fault = State.HOLDING, Fault.NONE
        return Result.DONE
