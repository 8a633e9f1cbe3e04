"""An interface is held by what it is: two names of it are one, and two interfaces are two."""

from collections.abc import Callable, Sequence
from pathlib import Path
from types import ModuleType

import pytest

from tests.firmware_sim.test_audio import portaudio  # noqa: F401
from tests.vibractl.fake_port_audio import FakePortAudio
from tests.vibractl.manual_stream import SharedStream
from vibractl import audio_device
from vibractl.audio_device import HeldDevice
from vibractl.audio_engine import Engine
from vibractl.audio_memory import Memory
from vibractl.audio_stream import AudioError
from vibractl.config import Audio, RigConfig

Hold = Callable[[str], HeldDevice]
LINUX = (
    ("HDA Intel PCH: ALC257 Analog (hw:0,0)", 0),
    ("Fireface: USB Audio (hw:2,0)", 0),
    ("Fireface: USB Audio #1 (hw:2,1)", 0),
    ("default", 0),
    ("default", 1),
)
MAC = (("Fireface", 0), ("Fireface", 0), ("Built-in Output", 0))


@pytest.fixture
def hold(portaudio: ModuleType, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Hold]:  # noqa: F811
    """Return what lets a test name the devices, and then hold one by a name."""

    def there_are(hosts: Sequence[str], devices: Sequence[tuple[str, int]], default: int = 0) -> Hold:
        monkeypatch.setattr(portaudio, "_lib", FakePortAudio(hosts, devices, default))
        monkeypatch.setattr(portaudio, "_ffi_string", bytes)
        return lambda name: HeldDevice(Audio(stream="sounddevice:Stream", device=name))

    return there_are


@pytest.fixture
def open_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the folder of links that stands for those to this process' open files."""
    (tmp_path / "0").symlink_to("/dev/null")
    monkeypatch.setattr(audio_device, "OPEN_FILES", tmp_path)
    return tmp_path


@pytest.mark.parametrize("other", ["Intel ALC257", "HDA Intel PCH: ALC257 Analog (hw:0,0), ALSA", ""])
def test_every_name_of_a_card_is_the_card(hold: Callable[..., Hold], other: str) -> None:
    hold = hold(("ALSA", "JACK"), LINUX)
    with hold("hw:0,0"), pytest.raises(AudioError, match=r"^audio device hw:0,0 is in use by process \d+"):
        hold(other)
    with hold(other):
        pass


def test_another_card_and_another_of_its_devices_are_free(hold: Callable[..., Hold]) -> None:
    hold = hold(("ALSA", "JACK"), LINUX)
    with hold("hw:0,0"), hold("hw:2,0"), hold("hw:2,1"), hold("default, ALSA"), hold("default, JACK"):
        pass


def test_two_interfaces_of_one_name_are_two_and_each_is_held(hold: Callable[..., Hold]) -> None:
    """Neither of them can be named; the default can."""
    first, second = hold(("Core Audio",), MAC, 0)(""), hold(("Core Audio",), MAC, 1)("")
    for number, default in enumerate((0, 1), start=1):
        with pytest.raises(AudioError, match=rf"audio device Fireface of Core Audio \({number} of 2\) is in use"):
            hold(("Core Audio",), MAC, default)("")
    with hold(("Core Audio",), MAC)("Built-in"):
        first.release()
        second.release()


def test_a_name_that_no_device_has_is_held_as_it_is(hold: Callable[..., Hold]) -> None:
    hold = hold(("ALSA", "JACK"), LINUX)
    with hold("nothing"), pytest.raises(AudioError, match="audio device nothing of sounddevice is in use"):
        hold("nothing")


def test_an_alias_is_held_by_the_card_that_it_has_opened(hold: Callable[..., Hold], open_files: Path) -> None:
    hold = hold(("ALSA", "JACK"), LINUX)
    with hold("default, ALSA") as alias:
        for direction in "pc":
            (open_files / f"7{direction}").symlink_to(f"/dev/snd/pcmC0D0{direction}")
        alias.take_opened(None)
        with pytest.raises(AudioError, match=r"^audio device hw:0,0 is in use"):
            hold("hw:0,0")
        with hold("hw:2,0"):
            pass
    with hold("hw:0,0") as card:
        card.take_opened(None)


def test_a_stream_that_has_opened_what_another_holds_is_closed_before_it_plays(
    hold: Callable[..., Hold], open_files: Path
) -> None:
    hold = hold(("ALSA", "JACK"), LINUX)
    (open_files / "7").symlink_to("/dev/snd/pcmC2D0p")
    alias = Audio(stream="tests.vibractl.manual_stream:SharedStream", device="shaker")
    engine = Engine(RigConfig(audio=alias), Memory(2, 2, 1000))
    with hold("hw:2,0"), pytest.raises(AudioError, match="audio device hw:2,0 is in use"):
        engine.start()
    assert not SharedStream.last.active
    with hold("hw:2,0"):
        pass
    engine.start()
    engine.close()


def test_a_simulated_card_is_each_programs_own(open_files: Path) -> None:
    (open_files / "7").symlink_to("/dev/snd/pcmC2D0p")
    with HeldDevice(Audio()) as first, HeldDevice(Audio()) as second:
        first.take_opened(None)
        second.take_opened(None)
