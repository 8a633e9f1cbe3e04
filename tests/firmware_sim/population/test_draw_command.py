"""The command that draws machines, over a population made up here."""

import json
import sys
import tomllib
from pathlib import Path

import pytest

from firmware_sim import __main__ as firmware_sim
from firmware_sim.population import kinds
from firmware_sim.population.draw import Draw, Population, Quantity
from rigkit.config import load
from vibractl.config import RigConfig


def bell(family: str, seed: int) -> Draw:
    """Draw a bell."""
    table = (Quantity("tone", 100.0 + seed, "Hz"), Quantity("clappers", 2), Quantity("modes", (1.5, 2.0), "Hz"))
    return Draw("vibrator", family, seed, table, {"audio.drive_channels": [4, 5], "simulator.options.seed": seed})


BELLS = Population("vibrator", ("church", "cow"), bell, ("cracked",))


@pytest.fixture(autouse=True)
def _bells(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kinds, "KINDS", {"vibrator": f"{__name__}:BELLS"})
    monkeypatch.setattr(kinds, "resolve", lambda _: BELLS)


def called(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    """Run `firmware-sim draw` and return its exit status."""
    monkeypatch.setattr(sys, "argv", ["firmware-sim", "draw", *words])
    return firmware_sim.main()


def test_it_shows_what_was_drawn_and_the_keys_that_fit(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert called(monkeypatch, "vibrator", "--seed", "7") == 0
    shown = capsys.readouterr().out
    assert f"vibrator 7, family {BELLS.family(7)}" in shown
    assert all(text in shown for text in ("107", "Hz", "1.5, 2", "audio.drive_channels", "[4, 5]"))


def test_its_rig_file_is_complete_and_says_which_machine_it_is_of(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    out = tmp_path / "bell.toml"
    words = ("--seed", "7", "--family", "cracked", "--out", str(out), "--set", "session.shots=3")
    assert called(monkeypatch, "vibrator", *words) == 0
    assert out.read_text().startswith("# firmware-sim draw vibrator --seed 7 --family cracked\n")
    config = load(out, RigConfig)
    assert config.audio.drive_channels == (4, 5)
    assert config.simulator.options == {"seed": 7}
    assert config.session.shots == 3
    assert set(tomllib.loads(out.read_text())) == set(RigConfig.model_fields)


def test_its_figures_are_written_as_json(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    file = tmp_path / "bell.json"
    assert called(monkeypatch, "vibrator", "--seed", "7", "--family", "cow", "--json", str(file)) == 0
    written = json.loads(file.read_text())
    assert (written["kind"], written["family"], written["seed"]) == ("vibrator", "cow", 7)
    assert written["drawn"]["tone"] == {"value": 107.0, "unit": "Hz"}
    assert written["rig"] == {"audio.drive_channels": [4, 5], "simulator.options.seed": 7}


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("anvil", "--seed", "7"), "KIND is 'anvil', must be vibrator"),
        (("vibrator", "--seed", "7", "--family", "sheep"), "is 'sheep', must be church, cow, cracked"),
        (("vibrator", "--seed", "7", "--set", "audio.rate=3"), "audio.rate"),
        (("vibrator", "--seed", "-1"), "-1"),
    ],
)
def test_what_cannot_be_drawn_is_refused_in_one_line(
    words: tuple[str, ...],
    said: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
) -> None:
    out = tmp_path / "bell.toml"
    assert called(monkeypatch, *words, "--out", str(out)) == 2
    refused = capsys.readouterr().err
    assert said in refused
    assert refused.count("\n") == 1
    assert not out.exists()


def test_seeds_choose_among_all_families_but_those_by_name() -> None:
    assert {BELLS.family(seed) for seed in range(30)} == {"church", "cow"}
