"""Without a server, or with wrong settings, `firmware-sim` says what is missing in one line."""

from collections.abc import Sequence

import pytest

from firmware_sim.__main__ import main


def run(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    monkeypatch.setattr("sys.argv", ["firmware-sim", *arguments])
    return main()


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["vibrator"], "no wire is chosen, must be --jack"),
        (["vibrator", "--jack", "--seed", "-1"], "Invalid value for '--seed'"),
        (["vibrator", "--jack", "--set", "simulator.options.nose=3"], "unexpected keyword argument 'nose'"),
        (["vibrator", "--jack", "--set", "simulator.plant=nope"], "simulator.plant is 'nope', must be vibrator"),
        (["vibrator", "--jack", "--config", "missing.toml"], "missing.toml"),
    ],
)
def test_what_cannot_be_done_is_one_line_and_status_2(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], arguments: Sequence[str], reason: str
) -> None:
    assert run(monkeypatch, *arguments) == 2
    errors = capfd.readouterr().err
    assert errors.startswith("error: ")
    assert reason in errors
    assert errors.count("\n") == 1


def test_without_a_server_it_says_how_to_start_one(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("jack", reason="JACK-Client or libjack is missing", exc_type=(ImportError, OSError))  # type: ignore[arg-type]
    monkeypatch.setenv("JACK_DEFAULT_SERVER", "nobody")
    monkeypatch.setenv("JACK_NO_START_SERVER", "1")
    assert run(monkeypatch, "vibrator", "--jack") == 2
    errors = capfd.readouterr().err
    assert "cannot join the JACK server as 'shaker'" in errors
    assert "jackd -d dummy -r 44100" in errors


def test_help_has_an_example(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    assert run(monkeypatch, "vibrator", "--help") == 0
    assert "firmware-sim vibrator --jack --seed 3" in capfd.readouterr().out
