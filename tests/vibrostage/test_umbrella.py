"""`vibrostage` calls all programs in one."""

import sys

import pytest

from vibrostage.__main__ import main
from vibrostage.application import PROGRAM


def call(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["vibrostage", *words])
    return main()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("stage", "example-config"), "[deflection]"),
        (("cell", "example-cell"), "[clamping]"),
        (("vibrator", "example-config"), "[adaptation]"),
        (("calibrate", "--help"), "calibrate [OPTIONS] COMMAND"),
        (("sim", "robot", "--help"), "sim robot [OPTIONS]"),
        (("plan", "--help"), "plan [OPTIONS]"),
        (("--help",), "vibrator"),
    ],
)
def test_a_program_is_called_by_its_word(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], words: tuple[str, ...], said: str
) -> None:
    assert call(monkeypatch, *words) == 0
    assert said in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize("word", PROGRAM.programs)
def test_each_has_help_of_its_own(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], word: str
) -> None:
    assert call(monkeypatch, word, "--help") == 0
    assert f"vibrostage {word}" in capsys.readouterr().out


def test_a_word_that_is_none_is_one_line(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(monkeypatch, "vibrater", "run") == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "No such command 'vibrater'" in line
    assert "vibrator" in line
