"""Live audio: one stream for the whole session, and recordings that are proved to be aligned, or repeated."""

import math
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import Protocol, Self

import numpy as np

from rigkit.latch import to_clear
from rigkit.patience import Patience
from rigkit.priority import all_real_time
from rigkit.stop import Stopped
from vibractl.audio_engine import Engine
from vibractl.audio_memory import Memory, Word
from vibractl.audio_process import AudioProcess
from vibractl.audio_stream import AudioError
from vibractl.capture import CLIPPED, Capture, Discarded, spoiled, told, unmoved
from vibractl.config import RigConfig
from vibractl.guard import Violation, as_violation, violation
from vibractl.levels import Levels, lately, levels
from vibractl.loopback import Loopback
from vibractl.loudness import too_loud
from vibractl.marker import Marker
from vibractl.proof import LARGEST_ROUND_TRIP, Emission, Proof
from vibractl.supervision import ALONE, Supervision

SECONDS = 40.0
"""Longest drive, unless the line is opened for another."""
SIGNS = 0.03
"""s that a waiting program may take from one sign of life to the next."""
_STANDSTILL = 5.0
"""s without a callback, while this program looks for one, after which the stream is given up."""


class ShotAbandoned(AudioError):
    """Every attempt at an emission was discarded."""


class Clipped(ShotAbandoned):
    """Every attempt was, since a sensor or its converter goes no further: what is emitted is too loud for it."""


class GuardLatched(AudioError):
    """The guard has shut itself; a person must clear it."""


class _Host(Protocol):
    """Where the stream lives: in this process or in one of its own."""

    def start(self) -> None: ...
    def serve(self) -> None: ...
    def close(self) -> None: ...


class Line:
    """The way to the vibrator and back: a context manager that holds the stream open, silent between emissions.

    Parameters
    ----------
    config : RigConfig
        `[audio]` and `[limits]`; a simulated stream reads `[simulator]` as well.
    seconds : float, s
        Longest drive that will be emitted.
    on_discard : callable(Discarded)
        Told of every recording that is thrown away, before the next attempt.
    supervision : Supervision

    Raises
    ------
    AudioError : on entry, when the stream cannot be opened or the timing signal does not come back.
    ValueError : the guard may let out more than the converter can play, or its ramp does not fit the limits.
    """

    def __init__(
        self,
        config: RigConfig,
        *,
        seconds: float = SECONDS,
        on_discard: Callable[[Discarded], None] = lambda _: None,
        supervision: Supervision = ALONE,
    ) -> None:
        audio, limits = config.audio, config.limits
        if limits.peak > audio.output_full_scale:
            raise ValueError(
                f"limits.peak is {limits.peak:g} V, must be <= audio.output_full_scale, {audio.output_full_scale:g} V"
            )
        self._audio, self._limits, self._seconds, self._on_discard = audio, limits, seconds, on_discard
        self._proof: Proof = Loopback(audio) if audio.alignment == "loopback" else Marker(audio, limits)
        room = round((seconds + 10 * LARGEST_ROUND_TRIP) * audio.rate)  # the probe and markers need some, too
        sensors = len(audio.response_channels), len(audio.far_field_channels)
        self.residual = math.nan
        """Of the last recording: its largest difference from the session's delay, samples."""
        self._memory = Memory(len(audio.drive_channels), sensors[0], room, sensors[1])
        self._memory.words[Word.PATIENCE] = round(1e9 * _patience(config, supervision.mute_after))
        # A stream without a clock may run in this very process: it would keep a core for itself.
        self._ahead: Callable[[], AbstractContextManager[None]] = (
            all_real_time if supervision.mute_after and audio.isolated else nullcontext
        )
        host = AudioProcess if audio.isolated else Engine
        self._host: _Host = host(config, self._memory, supervision.faults)

    def __enter__(self) -> Self:
        """Open the stream and measure the round trip."""
        silence = np.zeros((1, len(self._audio.drive_channels)))
        violation(silence, self._limits, self._audio.rate)  # compiles what `emit` calls, before the stream runs
        try:
            self._host.start()
            probe = self._proof.probe()
            self._play(probe)
            fault = self._proof.learn(self._memory.response[: probe.frames], self._memory.loopback[: probe.frames])
            if fault:
                raise AudioError(fault)
        except BaseException:
            self._host.close()
            raise
        return self

    def __exit__(self, *fault: object) -> None:
        """Ramp down and close the stream."""
        self._host.close()

    @property
    def levels(self) -> Levels:
        """What is played and heard now; from any thread."""
        return levels(self._memory, self._audio, self._limits)

    def lately(self, seconds: float) -> tuple[np.ndarray, np.ndarray]:
        """Return what was played and heard in the last `seconds`, as `levels.lately`; from any thread."""
        return lately(self._memory, self._audio, seconds)

    @property
    def round_trip(self) -> float:
        """The session's delay from output to input, samples."""
        return self._proof.first

    def emit(self, drive: np.ndarray) -> Capture:
        """Play a drive and record the responses to it, again if the recording cannot be trusted.

        Parameters
        ----------
        drive : array, shape (samples, drives), V
            Played from rest to rest: within the limits from its first sample to the return to zero after its last.

        Returns
        -------
        Capture

        Raises
        ------
        ValueError : the drive has the wrong shape or length, or would break a limit; nothing was played.
        ShotAbandoned : every one of `audio.attempts` was discarded; it says why, each reason once.
        Clipped : every one was, and all of them for that reason.
        GuardLatched : the guard has shut itself, now or before.
        Stopped : `stop` was called.
        AudioError : the stream has failed.
        """
        emission = self._proof.emission(self._checked(drive))
        broken = too_loud(emission.drive, self._limits, self._audio.rate)
        if broken:
            raise ValueError(f"the drive is not played: {broken}")
        reasons = []
        for attempt in range(1, self._audio.attempts + 1):
            self._play(emission)
            capture, reason = self._received(emission, len(drive))
            if not reason:
                return capture
            reasons.append(reason)
            self._on_discard(Discarded(attempt, reason, capture))
        raise (Clipped if all(reason.startswith(CLIPPED) for reason in reasons) else ShotAbandoned)(told(reasons))

    def stop(self) -> None:
        """Ramp down the emission under way, from another thread or a signal handler; `emit` raises `Stopped`."""
        self._memory.words[Word.STOP] = self._memory.words[Word.REQUEST]

    def clear(self, by: str) -> Violation:
        """Re-arm the guard in the name of the person who found out why it latched.

        Parameters
        ----------
        by : str
            Not empty.

        Returns
        -------
        Violation
            What is cleared.

        Raises
        ------
        ValueError : nobody is named, or the guard is not latched.
        """
        words = self._memory.words
        to_clear("the guard", words[Word.LATCHED], by)
        self._memory.text = by
        words[Word.CLEAR] += 1
        self._wait(Word.CLEARED, Word.CLEAR)
        return as_violation(self._memory.latch)

    def _checked(self, drive: np.ndarray) -> np.ndarray:
        drives = len(self._audio.drive_channels)
        longest = round(self._seconds * self._audio.rate)
        if drive.ndim != 2 or drive.shape[1] != drives or not 1 <= len(drive) <= longest:
            raise ValueError(
                f"the drive has shape {drive.shape}, must be (samples, {drives}) with 1 to {longest} samples"
            )
        return drive

    def _play(self, emission: Emission) -> None:
        memory, words = self._memory, self._memory.words
        if words[Word.LATCHED]:
            raise GuardLatched(f"the guard is latched: {as_violation(memory.latch)}; a person must clear it")
        memory.drive[: len(emission.drive)] = emission.drive
        memory.timing[: len(emission.timing)] = emission.timing
        words[Word.DRIVE], words[Word.TIMING] = len(emission.drive), len(emission.timing)
        words[Word.FRAMES] = emission.frames
        words[Word.REQUEST] += 1
        try:
            with self._ahead():  # for the signs of life to come in time
                self._wait(Word.DONE, Word.REQUEST)
        except KeyboardInterrupt:
            self.stop()
            self._wait(Word.DONE, Word.REQUEST)
            raise
        if words[Word.LATCHED]:
            raise GuardLatched(f"the guard has latched: {as_violation(memory.latch)}; a person must clear it")
        if words[Word.STOPPED] and not words[Word.MUTED]:
            raise Stopped("the emission was ramped down before its end, as asked")

    def _wait(self, word: Word, wanted: Word) -> None:
        words = self._memory.words
        patience = Patience(_STANDSTILL, step=1)
        while words[word] != words[wanted]:
            words[Word.SIGN] += 1
            self._host.serve()
            if words[Word.FAULT]:
                raise AudioError(self._memory.text)
            if patience.is_over(int(words[Word.CALLBACKS])):
                raise AudioError(f"the audio stream has stalled: no callback for {_STANDSTILL:g} s")

    def _received(self, emission: Emission, samples: int) -> tuple[Capture, str]:
        memory, words = self._memory, self._memory.words
        evidence = self._proof.judge(emission, memory.response, memory.loopback)
        self.residual = evidence.residual
        played = slice(emission.before, emission.before + samples)
        heard = slice(played.start + self._proof.whole, played.stop + self._proof.whole)
        capture = Capture(
            emitted=memory.emitted[played].copy(),
            response=memory.response[heard].copy(),
            far_field=memory.far_field[heard].copy(),
            loopback=memory.loopback[heard].copy(),
            delay=evidence.delay,
            residual=evidence.residual,
            quality=evidence.quality,
            input_xruns=int(words[Word.INPUT_XRUNS]),
            output_xruns=int(words[Word.OUTPUT_XRUNS]),
            late=int(words[Word.LATE]),
        )
        muted = "muted: this program stood still for too long" if words[Word.MUTED] else ""
        return capture, muted or self._spoiled(capture) or evidence.fault

    def _spoiled(self, capture: Capture) -> str:
        return spoiled(capture, self._audio) or unmoved(capture)


def _patience(config: RigConfig, mute_after: float) -> float:
    """Return for how long a drive goes on without a sign, s, so that it has faded to zero `mute_after` s after one.

    0 is for ever, for both.
    """
    if not mute_after:
        return 0.0
    block = config.audio.blocksize / config.audio.rate
    shortest = config.limits.ramp + 2 * block + SIGNS
    if mute_after < shortest:
        raise ValueError(
            f"daemon.mute_after is {mute_after:g} s, must be >= {shortest:.3g} s: limits.ramp, two blocks of "
            f"audio.blocksize and {SIGNS:g} s between two signs of life"
        )
    return mute_after - config.limits.ramp - 2 * block
