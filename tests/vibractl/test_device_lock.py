"""Two programs do not play on one interface: the second is told who has it."""

import pytest

from rigkit.machine_lock import MachineLock
from tests.vibractl.manual_stream import SharedStream
from vibractl.audio_engine import Engine
from vibractl.audio_memory import Memory
from vibractl.audio_stream import AudioError
from vibractl.config import Audio, RigConfig

AUDIO = Audio(stream="tests.vibractl.manual_stream:SharedStream", device="shaker")
NAME = "audio device shaker of tests.vibractl.manual_stream"


def engine() -> Engine:
    """Return an engine on that device."""
    return Engine(RigConfig(audio=AUDIO), Memory(2, 2, 1000))


def test_the_second_engine_is_refused_until_the_first_is_closed() -> None:
    first, second = engine(), engine()
    first.start()
    with pytest.raises(AudioError, match=rf"{NAME} is in use by process \d+ .*, since"):
        second.start()
    first.close()
    second.start()
    second.close()
    MachineLock(NAME).release()


def test_a_stream_that_does_not_open_leaves_the_device_free(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object, **__: object) -> None:
        raise OSError("no such card")

    monkeypatch.setattr(SharedStream, "__init__", fail)
    with pytest.raises(AudioError, match="no such card"):
        engine().start()
    MachineLock(NAME).release()
