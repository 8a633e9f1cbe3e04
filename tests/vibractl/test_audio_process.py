"""The stream in a process of its own: the same results, and a safe end whoever dies."""

import os
import select
import signal
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ctlblocks.block import Block
from rigkit.patience import processor_time
from tests.until import EVER, until
from vibractl import audio, audio_process
from vibractl.audio import AudioError, Line
from vibractl.audio_memory import Memory, Word
from vibractl.config import Audio, RigConfig, Simulator

RATE = 44_100
ROOT = Path(__file__).parents[2]

SESSION = """
import signal
import sys
import numpy as np
from vibractl.audio import Line
from vibractl.config import Audio, RigConfig, Simulator

signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job ignores it
log = {"file": sys.argv[1], "capacity": 30 * 44_100}
config = RigConfig(
    audio=Audio(isolated=True),
    simulator=Simulator(plant="tests.vibractl.drive_log:DriveLog", speed=1.0, options=log),
)
with Line(config) as line:
    print(line._host.pid, flush=True)
    time = np.arange(20 * 44_100) / 44_100
    tones = 3 * np.sin(2 * np.pi * 50 * time) * np.sin(np.pi * time / 20)
    line.emit(np.column_stack((tones, tones)))
"""


def rig(tmp_path: Path, speed: float = 0.0, **audio: Any) -> RigConfig:
    log = {"file": str(tmp_path / "log"), "capacity": 4 * RATE}
    simulator = Simulator(plant="tests.vibractl.drive_log:DriveLog", speed=speed, options=log)
    return RigConfig(audio=Audio(**({"isolated": True} | audio)), simulator=simulator)


def sweep() -> np.ndarray:
    time = np.arange(RATE // 2) / RATE
    return np.column_stack([np.sin(2 * np.pi * f * time) * np.sin(2 * np.pi * time) ** 2 for f in (40, 90)])


@pytest.mark.sample(1)
@pytest.mark.parametrize("speed", [0.0, 10.0])
def test_it_gives_what_the_stream_gives_in_this_process(tmp_path: Path, speed: float) -> None:
    captures = []
    for isolated in (True, False):
        with Line(rig(tmp_path, speed, isolated=isolated)) as line:
            captures.append([line.emit(sweep()) for _ in range(2)])
    for apart, here in zip(*captures, strict=True):
        assert apart.response.tobytes() == here.response.tobytes()
        assert apart.emitted.tobytes() == here.emitted.tobytes()
        assert apart.delay == here.delay
        assert np.abs(apart.response).max() > 0.9


def test_what_cannot_be_opened_there_is_said_here(tmp_path: Path) -> None:
    with pytest.raises(AudioError, match="cannot open audio.device 'USB'"), Line(rig(tmp_path, device="USB")):
        pass
    bad = rig(tmp_path).model_copy(update={"simulator": Simulator(plant="vibrator", options={"seeds": 1})})
    with (
        pytest.raises(AudioError, match="Vibrator does not take these options: .*seeds.*; there are seed,"),
        Line(bad),
    ):
        pass


def test_when_the_audio_process_is_killed_the_program_is_told(tmp_path: Path) -> None:
    with Line(rig(tmp_path, speed=1.0)) as line:
        pid = line._host.pid  # type: ignore[attr-defined]  # noqa: SLF001
        line.emit(sweep())
        os.kill(pid, signal.SIGKILL)
        with pytest.raises(AudioError, match=f"the audio process {pid} has died, exit code -9"):
            line.emit(sweep())


@pytest.mark.sample(1)
@pytest.mark.parametrize("how", ["kill -9", "Ctrl-C", "kill the child"])
def test_whoever_ends_in_mid_shot_the_drive_ramps_down(tmp_path: Path, how: str) -> None:
    log = tmp_path / "log"
    program = subprocess.Popen(
        [sys.executable, "-c", SESSION, str(log)],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    with program:
        assert program.stdout is not None
        child = int(program.stdout.readline())
        alive = os.pidfd_open(child)
        wait_until_loud(log)
        if how == "kill -9":
            program.kill()
        elif how == "Ctrl-C":
            os.killpg(program.pid, signal.SIGINT)
        else:
            os.kill(child, signal.SIGTERM)
        assert select.select([alive], [], [], EVER)[0], "the audio process did not end"
        os.close(alive)
        errors = program.communicate(timeout=EVER)[1]
    if how == "Ctrl-C":
        assert "KeyboardInterrupt" in errors
    if how == "kill the child":
        assert "Stopped: the emission was ramped down before its end" in errors
    drive = np.fromfile(log).reshape(-1, 2)
    drive = drive[np.isfinite(drive[:, 0])]
    assert np.abs(drive).max() > 0.05
    assert len(drive) < 15 * RATE
    assert not drive[-10:].any()
    assert np.abs(np.diff(drive, axis=0)).max() * RATE < 20_000


def wait_until_loud(log: Path) -> None:
    """Return when the file shows a drive."""

    def loudest() -> float:
        drive = np.fromfile(log).reshape(-1, 2)
        return float(np.nanmax(np.abs(drive), initial=0.0, where=np.isfinite(drive)))

    until(lambda: loudest() > 0.05)


def test_shared_memory_carries_text_and_refuses_nothing_that_fits() -> None:
    memory = Memory(2, 3, 1000)
    memory.text = "Ada Lovelace, née Byron"
    assert memory.text == "Ada Lovelace, née Byron"
    memory.text = "x" * 10_000
    assert len(memory.text) == 4096
    assert [array.shape for array in (memory.drive, memory.response, memory.emitted, memory.loopback)] == [
        (1000, 2),
        (1000, 3),
        (1000, 2),
        (1000,),
    ]
    for value, array in enumerate((memory.words, memory.latch, memory.drive, memory.response, memory.timing), 1):
        array[:] = value
    assert (memory.words == 1).all()
    assert len(memory.words) == len(Word)
    assert (memory.latch == 2).all()
    assert (memory.drive == 3).all()
    assert memory.text == "x" * 4096


class Hanging(Block):
    """A plant that is never there."""

    def __init__(self) -> None:
        threading.Event().wait()


@pytest.mark.slow
def test_a_process_that_stands_still_before_its_stream_runs_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(audio_process, "_LONGEST_IDLE", 0.5)
    hanging = Simulator(plant="tests.vibractl.test_audio_process:Hanging")
    line = Line(RigConfig(audio=Audio(isolated=True), simulator=hanging))
    with pytest.raises(AudioError, match=r"the audio process has not responded for 0\.5 s while it \w+"), line:
        pass
    assert not processor_time(line._host.pid)  # type: ignore[attr-defined]  # noqa: SLF001


def test_a_process_that_works_for_ever_before_its_stream_runs_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(audio_process, "_LONGEST_WORK", 0.05)
    with pytest.raises(AudioError, match="the audio process still imports its modules, after 0 s of processor"):
        Line(RigConfig(audio=Audio(isolated=True))).__enter__()


def test_a_stream_that_stands_still_is_given_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(audio, "_STANDSTILL", 0.5)
    with Line(rig(tmp_path, speed=1.0)) as line:
        pid = line._host.pid  # type: ignore[attr-defined]  # noqa: SLF001
        os.kill(pid, signal.SIGSTOP)
        with pytest.raises(AudioError, match=r"the audio stream has stalled: no callback for 0\.5 s"):
            line.emit(sweep())
        os.kill(pid, signal.SIGCONT)
