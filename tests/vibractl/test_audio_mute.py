"""A program that stands still does not go on playing."""

import os
import select
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.until import EVER, until
from tests.vibractl.manual_stream import ManualStream
from tests.vibractl.test_audio_process import wait_until_loud
from vibractl import audio_engine
from vibractl.audio import Line
from vibractl.audio_engine import Engine
from vibractl.audio_memory import Memory, Word
from vibractl.config import Audio, Limits, RigConfig
from vibractl.supervision import Supervision

ROOT = Path(__file__).parents[2]
BLOCK, RATE = 512, 44_100
MUTE_AFTER = 0.1


class Clocked:
    """An engine on a stream whose time is counted in blocks."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, patience: float) -> None:
        stream = "tests.vibractl.manual_stream:ManualStream"
        config = RigConfig(audio=Audio(stream=stream, blocksize=BLOCK, heartbeat_output=4))
        self.memory = Memory(2, 2, 5 * RATE)
        self.words = self.memory.words
        self.words[Word.PATIENCE] = round(1e9 * patience)
        self._now = 0
        monkeypatch.setattr(audio_engine.time, "monotonic_ns", lambda: self._now)
        self._engine = Engine(config, self.memory)
        self._engine.start()
        self.played_last = np.zeros((BLOCK, 4), np.float32)
        self.memory.drive[:] = 1.0
        self.memory.drive[:BLOCK] *= np.linspace(0, 1, BLOCK)[:, None]
        self.words[Word.DRIVE] = self.words[Word.FRAMES] = 4 * RATE
        self.words[Word.REQUEST] = 1

    def played(self, seconds: float, signs: bool) -> np.ndarray:
        """Return what the first drive plays meanwhile, V, while the program gives signs or none."""
        blocks = []
        for _ in range(round(seconds * RATE / BLOCK)):
            self._now += round(1e9 * BLOCK / RATE)
            self.words[Word.SIGN] += signs
            self.played_last = ManualStream.last.exchange()
            blocks.append(10 * self.played_last[:, 0])
        return np.concatenate(blocks)


def test_the_drive_is_at_zero_a_tenth_of_a_second_after_the_last_sign(monkeypatch: pytest.MonkeyPatch) -> None:
    ramp = Limits().ramp
    clocked = Clocked(monkeypatch, MUTE_AFTER - ramp - 2 * BLOCK / RATE)
    assert clocked.played(1.0, signs=True)[-BLOCK:].min() == 1.0
    after = clocked.played(0.5, signs=False)
    assert after[: round((MUTE_AFTER - ramp - 3 * BLOCK / RATE) * RATE)].min() == 1.0
    assert not after[round(MUTE_AFTER * RATE) :].any()
    assert np.abs(np.diff(after)).max() * RATE < Limits().slew
    assert clocked.words[Word.MUTED] == 1
    assert clocked.words[Word.DONE] == 1


def test_the_heartbeat_is_a_tone_without_a_break_until_the_program_stands_still(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clocked = Clocked(monkeypatch, 0.05)
    tones = []
    for _ in range(20):
        clocked.played(0.02, signs=True)
        tones.append(clocked.played_last[:, 3].copy())
    tone = np.concatenate(tones)
    assert np.abs(tone).max() == pytest.approx(0.5, abs=0.01)
    lines = np.abs(np.fft.rfft(tone))
    assert np.argmax(lines) * RATE / len(tone) == pytest.approx(1000, abs=50)
    assert np.delete(lines, np.argmax(lines)).max() < 1e-3 * lines.max()
    clocked.played(0.2, signs=False)
    assert not clocked.played_last.any()


def test_without_patience_it_plays_on(monkeypatch: pytest.MonkeyPatch) -> None:
    clocked = Clocked(monkeypatch, 0.0)
    clocked.played(0.5, signs=True)
    assert clocked.played(2.0, signs=False).min() == 1.0


def test_a_time_that_cannot_be_kept_is_refused() -> None:
    with pytest.raises(ValueError, match=r"daemon.mute_after is 0.1 s, must be >= 0.143 s: limits.ramp, two blocks"):
        Line(RigConfig(audio=Audio(blocksize=2048)), supervision=Supervision(0.1))


SESSION = """
import sys
import numpy as np
from vibractl.audio import Line
from vibractl.config import Audio, RigConfig, Simulator
from vibractl.supervision import Supervision

log = {"file": sys.argv[1], "capacity": 60 * 44_100}
plant = Simulator(plant="tests.vibractl.drive_log:DriveLog", speed=1.0, options=log)
tell = lambda discarded: print(discarded.reason, flush=True)
config = RigConfig(audio=Audio(isolated=True), simulator=plant)
with Line(config, supervision=Supervision(0.5), on_discard=tell) as line:
    print(line._host.pid, flush=True)
    time = np.arange(20 * 44_100) / 44_100
    tones = 3 * np.sin(2 * np.pi * 50 * time) * np.sin(np.pi * time / 20)
    line.emit(np.column_stack((tones, tones)))
"""


@pytest.mark.deadline(0.25)
def test_a_program_that_is_stopped_in_mid_shot_goes_silent_and_repeats_the_shot_afterwards(tmp_path: Path) -> None:
    log = tmp_path / "log"
    program = subprocess.Popen(
        [sys.executable, "-c", SESSION, str(log)], cwd=ROOT, stdout=subprocess.PIPE, text=True, start_new_session=True
    )
    with program:
        assert program.stdout is not None
        alive = os.pidfd_open(int(program.stdout.readline()))
        wait_until_loud(log)
        program.send_signal(signal.SIGSTOP)
        until(lambda: _is_silent(log))
        program.send_signal(signal.SIGCONT)
        assert program.stdout.readline() == "muted: this program stood still for too long\n"
        program.kill()
        assert select.select([alive], [], [], EVER)[0], "the audio process did not end"
        os.close(alive)


def _is_silent(log: Path) -> bool:
    """Whether the last fifth of a second was silent, after something was played."""
    drive = np.fromfile(log).reshape(-1, 2)
    drive = drive[np.isfinite(drive[:, 0])]
    return bool(np.abs(drive).max() > 0.05 and not drive[-RATE // 5 :].any())
