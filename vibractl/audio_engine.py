"""What runs behind the audio callback: one graph for the whole session, and the phases of an emission."""

import time
from collections.abc import Callable
from contextlib import ExitStack
from typing import Any

import numpy as np

from rigkit.faults import FaultTable
from rigkit.relay.config import Relay
from vibractl.audio_device import HeldDevice
from vibractl.audio_memory import Memory, Word
from vibractl.audio_stream import open_stream
from vibractl.config import RigConfig
from vibractl.guard import Guard
from vibractl.heartbeat import heartbeat
from vibractl.spoiled_input import SpoiledInput
from vibractl.trial import FrameInput, Trial, shot_graph

_IDLE, _OPENING, _PLAYING, _CLOSING = range(4)
POLL = 0.005
"""s between two looks at a stream with a clock of its own."""
_LONGEST_RUN = 100
"""Blocks a stream without a clock is run for, between two looks."""


class Engine:
    """The stream, its callback and the graph behind it; told what to do through shared memory.

    An emission is: open the guard (trial silent), play and record, close the guard.  In between, zeros are played.

    Parameters
    ----------
    config : RigConfig
    memory : Memory
    faults : FaultTable or None
        Put into what the card hears.
    """

    def __init__(self, config: RigConfig, memory: Memory, faults: FaultTable | None = None) -> None:
        audio = config.audio
        self._memory, self._words = memory, memory.words
        self._drives = [channel - 1 for channel in audio.drive_channels]
        self._responses = [channel - 1 for channel in audio.response_channels]
        self._hydrophones = [channel - 1 for channel in audio.far_field_channels]
        loopback = audio.alignment == "loopback"
        self._loopback = (audio.loopback_output - 1, audio.loopback_input - 1) if loopback else None
        self._output_scale, self._input_scale = 1 / audio.output_full_scale, audio.input_full_scale
        self._far_scale = np.float32(audio.far_field_full_scale)
        self._blocksize, self._rate = audio.blocksize, audio.rate
        self._heartbeat = audio.heartbeat_output - 1
        self._tone = heartbeat(audio.rate, audio.blocksize)
        self._relay = _relay(audio.relay, self._pulse)
        self._guard = Guard(config.limits, len(self._drives))
        self._trial = Trial(memory.drive[:0], len(self._responses))
        self._input = FrameInput(len(self._responses))
        self._graph = shot_graph(self._input, self._trial, self._guard, audio.rate, audio.blocksize)
        self._graph.prepare()
        self._graph.tick()  # compiles
        self._graph.prepare()
        self._output = self._graph.signal("guard.output")
        self._scaled = np.zeros_like(self._output)
        self._faults = None if faults is None else SpoiledInput(faults, audio.rate, audio.blocksize)
        self._phase = _IDLE
        self._latest = 0  # ns, when the last callback began
        self._sign, self._signed = 0, 0  # the program's last sign of life, and when it came, ns
        signals = memory.drive, memory.timing, memory.emitted, memory.response, memory.far_field, memory.loopback
        for array in signals:
            array.fill(0.0)  # maps every page now, not in the callback
        self._config = config
        self._stream: Any = None
        self._held = ExitStack()
        self.stepped = False
        """Whether the stream has no clock of its own; known once started."""

    def start(self) -> None:
        """Open and start the stream: zeros from now on.

        Raises
        ------
        AudioError, RelayError : it, or the bus to the relay, cannot be opened.
        """
        with ExitStack() as opened:
            device = opened.enter_context(HeldDevice(self._config.audio))
            self._relay.start()
            opened.callback(self._relay.stop)
            self._stream = open_stream(self._config, self.callback)
            device.take_opened(self._stream)
            self.stepped = hasattr(self._stream, "advance")
            self._stream.start()
            self._held = opened.pop_all()
        self._words[Word.READY] = 1

    def serve(self) -> None:
        """Let the stream run for a moment, and see that it still does."""
        words = self._words
        if not self.stepped or not self._wanted:
            time.sleep(POLL)
        for _ in range(_LONGEST_RUN if self.stepped else 0):
            if words[Word.FAULT] or not self._wanted:
                break
            self._stream.advance(self._blocksize)
        if not words[Word.FAULT] and not self._stream.active:
            self._fail("the audio stream has ended by itself: is the interface still there?")
        if words[Word.FAULT] and self._stream.active:
            self._stream.abort()

    def close(self) -> None:
        """Ramp down what is being played, then close the stream.

        One that was never opened, or has ended by itself, is left alone: PortAudio waits forever for a server that is
        gone, when it closes a stream and when the program ends.  So that only an `AudioProcess` gets rid of one.
        """
        if self._stream is None or not self._stream.active:
            self._held.close()
            return
        self._words[Word.STOP] = self._words[Word.REQUEST]
        deadline = time.monotonic() + self._guard.limits.ramp + 1.0
        while self._busy and not self._words[Word.FAULT] and time.monotonic() < deadline:
            self.serve()
        self._relay.stop()
        self._stream.stop()
        self._stream.close()
        self._held.close()

    def callback(self, indata: np.ndarray, outdata: np.ndarray, frames: int, now: Any, status: Any) -> None:
        """Exchange one block with the device: `indata` (frames, inputs), `outdata` (frames, outputs), full scale 1.

        It fills `outdata` whatever happens, and lets no exception out.
        """
        filled = False
        try:
            if not self._words[Word.FAULT]:
                self._exchange(indata, outdata, frames, status)
                filled = True
        except Exception as fault:
            self._fail(f"the audio callback failed: {type(fault).__name__}: {fault}")
        finally:
            if not filled:
                outdata.fill(0.0)

    def _pulse(self) -> int | None:
        """Return what moves on while all is well, for the relay: the tone's conditions."""
        words = self._words
        words[Word.BEATS] = self._relay.sent
        silent = words[Word.FAULT] or words[Word.LATCHED] or words[Word.MUTED]
        return None if silent else int(words[Word.CALLBACKS])

    @property
    def _busy(self) -> bool:
        return bool(self._words[Word.REQUEST] != self._words[Word.DONE])

    @property
    def _wanted(self) -> bool:
        return self._busy or bool(self._words[Word.CLEAR] != self._words[Word.CLEARED])

    def _fail(self, text: str) -> None:
        self._memory.text = text
        self._words[Word.FAULT] = 1

    def _exchange(self, indata: np.ndarray, outdata: np.ndarray, frames: int, status: Any) -> None:
        if frames != self._blocksize:
            raise ValueError(f"the device asks for {frames} samples, must be audio.blocksize, {self._blocksize}")
        self._watch(status)
        if self._faults is not None:
            indata = self._faults.spoiled(indata)
        for column, channel in enumerate(self._responses):
            self._input.frame[:, column] = indata[:, channel]
        self._input.frame *= self._input_scale
        self._next_phase()
        position = self._trial.position
        self._graph.tick()
        np.multiply(self._output, self._output_scale, out=self._scaled)
        outdata.fill(0.0)
        for column, channel in enumerate(self._drives):
            outdata[:, channel] = self._scaled[:, column]
        if self._heartbeat >= 0 and not (self._guard.latched or self._words[Word.MUTED]):
            outdata[:, self._heartbeat] = self._tone
        if self._phase in (_PLAYING, _CLOSING):
            self._keep(position, indata, outdata)
        if self._guard.latched and not self._words[Word.LATCHED]:
            self._memory.latch[:] = self._guard.latch
            self._words[Word.LATCHED] = 1

    def _watch(self, status: Any) -> None:
        words, now = self._words, time.monotonic_ns()
        if self._phase != _IDLE:
            if status:
                words[Word.INPUT_XRUNS] += bool(status.input_overflow or status.input_underflow)
                words[Word.OUTPUT_XRUNS] += bool(status.output_overflow or status.output_underflow)
            if not self.stepped and now - self._latest > 2e9 * self._blocksize / self._rate:
                words[Word.LATE] += 1
        self._latest = now
        words[Word.CALLBACKS] += 1

    def _next_phase(self) -> None:
        words, guard, trial = self._words, self._guard, self._trial
        if self._phase == _IDLE:
            if words[Word.CLEAR] != words[Word.CLEARED]:
                guard.clear(self._memory.text)
                words[Word.LATCHED] = 0
                words[Word.CLEARED] = words[Word.CLEAR]
            if self._busy:
                self._begin()
        if self._phase == _OPENING and (guard.is_open or not words[Word.DRIVE]):
            trial.rewind()
            self._phase = _PLAYING
        stop = words[Word.STOP] == words[Word.REQUEST]
        if self._phase in (_OPENING, _PLAYING) and self._abandoned():
            words[Word.MUTED], stop = 1, True
        if self._phase in (_OPENING, _PLAYING) and (stop or guard.latched or self._recorded):
            words[Word.STOPPED] = int(not self._recorded)
            guard.close()
            self._phase = _CLOSING
        if self._phase == _CLOSING and guard.is_closed:
            trial.park()
            self._phase = _IDLE
            words[Word.DONE] = words[Word.REQUEST]

    def _abandoned(self) -> bool:
        """Whether the program has given no sign for longer than it may."""
        words = self._words
        if words[Word.SIGN] != self._sign:
            self._sign, self._signed = int(words[Word.SIGN]), self._latest
        silent = self._latest - self._signed
        return bool(words[Word.PATIENCE]) and not self.stepped and bool(silent > words[Word.PATIENCE])

    @property
    def _recorded(self) -> bool:
        return self._phase == _PLAYING and self._trial.done

    def _begin(self) -> None:
        words, memory = self._words, self._memory
        for word in (Word.STOPPED, Word.MUTED, Word.INPUT_XRUNS, Word.OUTPUT_XRUNS, Word.LATE, Word.POSITION):
            words[word] = 0
        self._signed = self._latest
        self._trial.load(memory.drive[: words[Word.DRIVE]], memory.response[: words[Word.FRAMES]])
        if words[Word.DRIVE]:
            self._guard.open()
        self._phase = _OPENING

    def _keep(self, position: int, indata: np.ndarray, outdata: np.ndarray) -> None:
        """Play the timing signal; keep what left the guard, what hydrophones heard and what came through the cable."""
        words, memory = self._words, self._memory
        played = min(max(int(words[Word.DRIVE]) - position, 0), self._blocksize)
        memory.emitted[position : position + played] = self._output[:played]
        kept = min(max(int(words[Word.FRAMES]) - position, 0), self._blocksize)
        for column, channel in enumerate(self._hydrophones):
            heard = memory.far_field[position : position + kept, column]
            np.multiply(indata[:kept, channel], self._far_scale, out=heard)
        if self._loopback is not None:
            to, back = self._loopback
            timed = min(max(int(words[Word.TIMING]) - position, 0), self._blocksize)
            outdata[:timed, to] = memory.timing[position : position + timed]
            memory.loopback[position : position + kept] = indata[:kept, back]
        words[Word.POSITION] = position + kept


class _NoRelay:
    """What a rig without a relay has in place of a `Heartbeat`."""

    sent = 0

    def start(self) -> None:
        """Send nothing."""

    stop = start


def _relay(relay: Relay, pulse: Callable[[], int | None]) -> Any:
    if not relay.bus:
        return _NoRelay()
    from rigkit.relay.heartbeat import Heartbeat  # python-can is imported only where there is a relay

    return Heartbeat(relay, pulse)
