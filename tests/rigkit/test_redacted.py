"""Settings without names: numbers and choices stay, private texts go, wherever else they are said."""

import getpass
import tomllib
from pathlib import Path

from rigkit.config import load
from rigkit.redacted import Redaction
from vibractl.config import RigConfig


def test_numbers_choices_defaults_code_and_forms_stay_and_all_other_texts_become_their_keys() -> None:
    given = (
        "rig.name=Ada", "audio.device=USB of Ada", "reference.signal=chirp:40:90:5", "learning.law=thesis",
        "simulator.options.seed=3", "simulator.options.file=/home/ada/x.wav", "simulator.plant=own:Plant",
        "daemon.hosts=['ada.example']",
    )  # fmt: skip
    shown = tomllib.loads(Redaction().config(load(None, RigConfig, given)))
    assert shown["rig"]["name"] == "<rig.name>"
    assert shown["audio"]["device"] == "<audio.device>"
    assert shown["audio"]["stream"] == "firmware_sim.audio:Stream"
    assert shown["reference"]["signal"] == "chirp:40:90:5"
    assert shown["learning"]["law"] == "thesis"
    assert shown["simulator"]["plant"] == "own:Plant"
    assert shown["simulator"]["options"] == {"seed": 3, "file": "<simulator.options.file>"}
    assert shown["daemon"]["hosts"] == ["<daemon.hosts>"]


def test_a_reference_that_is_a_file_goes() -> None:
    shown = tomllib.loads(Redaction().config(load(None, RigConfig, ["reference.signal=ada/sweep.wav"])))
    assert shown["reference"]["signal"] == "<reference.signal>"


def test_what_was_hidden_is_hidden_elsewhere_and_no_part_of_a_word_is() -> None:
    redaction = Redaction()
    redaction.config(load(None, RigConfig, ["audio.device=ada"]))
    assert redaction.text("ada opens the adapter") == "<audio.device> opens the adapter"
    said = redaction.text(f"{Path.home()}/runs of {getpass.getuser()}")
    assert str(Path.home()) not in said or str(Path.home()) == "/"
