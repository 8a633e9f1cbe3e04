"""The relay in the amplifier's supply: closed while the line is open and well, open whatever goes wrong."""

import os
import select
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from rigkit.relay.bus import RelayError
from rigkit.relay.config import Relay
from tests.rigkit.relay.listening import behind_an_adapter, on_the_virtual_bus, virtual
from tests.until import EVER
from tests.vibractl.manual_stream import ManualStream
from vibractl.audio import Line
from vibractl.audio_engine import Engine
from vibractl.audio_memory import Memory, Word
from vibractl.config import Audio, RigConfig, Simulator

ROOT = Path(__file__).parents[2]
RATE = 44_100


@contextmanager
def playing(channel: str, drive: float) -> Iterator[Memory]:
    """Play a constant drive, V, on a stream that never ends, with a relay on the virtual bus."""
    stream = "tests.vibractl.manual_stream:ManualStream"
    memory = Memory(2, 2, 5 * RATE)
    audio = Audio(stream=stream, relay=Relay(**virtual(channel)))
    engine = Engine(RigConfig(audio=audio), memory)
    engine.start()
    memory.drive[:] = np.linspace(0, drive, RATE)[np.minimum(np.arange(len(memory.drive)), RATE - 1), None]
    memory.words[Word.DRIVE] = memory.words[Word.FRAMES] = 4 * RATE
    over, pause = threading.Event(), threading.Event()

    def exchange() -> None:
        while not over.is_set():
            ManualStream.last.exchange()
            pause.wait(0.01)

    thread = threading.Thread(target=exchange)
    thread.start()
    try:
        yield memory
    finally:
        over.set()
        thread.join()
        engine.close()


def test_it_is_closed_while_the_stream_runs_and_opens_when_the_guard_latches() -> None:
    with on_the_virtual_bus("latch") as heard, playing("latch", drive=100.0) as memory:
        heard.until(closed=True)
        assert memory.words[Word.BEATS] > 0
        memory.words[Word.REQUEST] = 1
        heard.until(closed=False)
        assert memory.words[Word.LATCHED] == 1
        callbacks = int(memory.words[Word.CALLBACKS])
        memory.text = "Ada"
        memory.words[Word.CLEAR] = 1
        heard.until(closed=True)
        assert memory.words[Word.CALLBACKS] > callbacks  # the stream went on all the time


@pytest.mark.parametrize("word", [Word.MUTED, Word.FAULT])
def test_it_opens_when_the_program_stands_still_or_the_stream_fails(word: Word) -> None:
    with on_the_virtual_bus(word.name) as heard, playing(word.name, drive=1.0) as memory:
        heard.until(closed=True)
        memory.words[word] = 1
        heard.until(closed=False)


def test_it_opens_when_the_line_is_closed() -> None:
    with on_the_virtual_bus("closed") as heard:
        with playing("closed", drive=1.0):
            heard.until(closed=True)
        heard.until(closed=False)


SESSION = """
import sys
import threading
import time
import numpy as np
from vibractl.audio import Line
from vibractl.audio_memory import Word
from vibractl.config import Audio, RigConfig, Simulator
from vibractl.supervision import Supervision
from tests.rigkit.relay.listening import on_a_port
from pathlib import Path

log = {"file": sys.argv[1] + "/log", "capacity": 60 * 44_100}
plant = Simulator(plant="tests.vibractl.drive_log:DriveLog", speed=1.0, options=log)
config = RigConfig(audio=Audio(isolated=True, relay=on_a_port(Path(sys.argv[1]))), simulator=plant)
with Line(config, supervision=Supervision(0.5)) as line:
    line._memory.words[Word.POSITION] = 0  # the probe's

    def tell():
        while not line._memory.words[Word.POSITION]:
            time.sleep(0.01)
        print(line._host.pid, flush=True)

    threading.Thread(target=tell).start()
    seconds = np.arange(20 * 44_100) / 44_100
    tones = np.sin(2 * np.pi * 50 * seconds) * np.sin(np.pi * seconds / 20)
    while True:
        line.emit(np.column_stack((tones, tones)))
"""


@pytest.mark.deadline(0.25)
def test_it_opens_when_the_program_is_stopped_in_mid_shot_or_killed(tmp_path: Path) -> None:
    with behind_an_adapter(tmp_path) as (heard, _):
        program = subprocess.Popen(
            [sys.executable, "-c", SESSION, str(tmp_path)], cwd=ROOT, stdout=subprocess.PIPE, text=True
        )
        try:
            assert program.stdout is not None
            audio = os.pidfd_open(int(program.stdout.readline()))
            heard.until(closed=True)
            program.send_signal(signal.SIGSTOP)
            heard.until(closed=False)
            program.send_signal(signal.SIGCONT)
            heard.until(closed=True)
            program.kill()
            heard.until(closed=False)
            assert select.select([audio], [], [], EVER)[0], "the audio process did not end"
            os.close(audio)
        finally:
            program.kill()
            program.communicate()


def test_without_the_relays_bus_the_line_stays_closed() -> None:
    away = Relay(bus="can:Bus", channel="/nowhere", options={"interface": "slcan"})
    config = RigConfig(audio=Audio(isolated=False, relay=away), simulator=Simulator())
    with pytest.raises(RelayError, match="can:Bus cannot open relay.channel '/nowhere'"), Line(config):
        pass


def test_a_heart_that_would_beat_quicker_than_the_blocks_is_refused() -> None:
    with pytest.raises(ValidationError, match=r"audio.relay.period is 0.05 s, must be >= 0.0929 s, two blocks"):
        Audio(blocksize=2048, relay=Relay(bus="can:Bus"))
    assert Audio(blocksize=2048).relay.period == 0.05
