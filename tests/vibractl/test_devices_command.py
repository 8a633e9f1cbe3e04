"""`vibractl devices`: what PortAudio lists, and which of it a rig can use."""

import json
import sys
from types import ModuleType
from typing import Any

import pytest

from vibractl.__main__ import main


def portaudio(monkeypatch: pytest.MonkeyPatch, *devices: tuple[str, int, int]) -> None:
    """Stand for a library that lists these: name, inputs, outputs."""
    listed = [
        {"index": n, "name": name, "hostapi": 0, "max_input_channels": inputs, "max_output_channels": outputs,
         "default_samplerate": 48_000.0}
        for n, (name, inputs, outputs) in enumerate(devices)
    ]  # fmt: skip
    library: Any = ModuleType("sounddevice")
    library.query_devices = lambda: listed
    library.query_hostapis = lambda: ({"name": "ALSA"},)
    monkeypatch.setitem(sys.modules, "sounddevice", library)


def vibractl(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr("sys.argv", ["vibractl", "devices", *words])
    return main()


def test_it_says_which_devices_have_enough_channels(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    portaudio(monkeypatch, ("Codec (hw:0,0)", 2, 2), ("Eight: USB Audio (hw:2,0)", 8, 8))
    assert vibractl(monkeypatch) == 0
    shown = capsys.readouterr().out
    assert "the rig file needs 3 inputs and 3 outputs of one device" in shown
    rows = {line.split()[0]: line.split() for line in shown.splitlines() if "hw:" in line}
    assert rows["0"][-1] == "no"
    assert rows["1"][1:] == ["Eight:", "USB", "Audio", "(hw:2,0)", "ALSA", "8", "8", "48000", "yes"]


def test_the_rig_file_says_how_many_are_needed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    portaudio(monkeypatch, ("Codec (hw:0,0)", 2, 2))
    assert vibractl(monkeypatch, "--set", "audio.alignment=marker", "--json", "-") == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["inputs"], found["outputs"], found["devices"][0]["enough"]) == (2, 2, True)


def test_no_device_is_said_in_words(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    portaudio(monkeypatch)
    assert vibractl(monkeypatch) == 0
    assert "the system lists no audio device: is the interface connected" in capsys.readouterr().out


def test_a_library_that_is_missing_is_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    portaudio(monkeypatch)

    def absent() -> None:
        raise OSError("PortAudio library not found")

    monkeypatch.setattr(sys.modules["sounddevice"], "query_hostapis", absent)
    assert vibractl(monkeypatch) == 2
    said = capsys.readouterr().err
    assert "error: audio devices cannot be listed: PortAudio library not found; on Debian: apt-get install" in said
