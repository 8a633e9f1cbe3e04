"""The doctor at the shell: what it says before and after, its exit status, and Ctrl-C."""

import json
import tomllib
import zipfile
from pathlib import Path

import numpy as np
import pytest

from tests.vibractl.doctor.doctor_rig import spoil
from vibractl.__main__ import main
from vibractl.audio_engine import Engine


def call(monkeypatch: pytest.MonkeyPatch, *arguments: object) -> int:
    command = ["vibractl", "doctor", "--set", "audio.isolated=false", *map(str, arguments)]
    monkeypatch.setattr("sys.argv", command)
    return main()


def test_it_says_what_it_will_play_and_then_what_it_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, "--json", tmp_path / "d.json", "--report", tmp_path / "d.html") == 0
    out = capsys.readouterr().out
    assert out.index("0.285 V (30 dB under limits.peak)") < out.index("verdicts of the doctor")
    figures = json.loads((tmp_path / "d.json").read_text())
    assert figures["verdict"] == "pass"
    assert [each["check"] for each in figures["checks"]][:2] == ["card", "recordings"]
    hum = next(each for each in figures["checks"] if each["check"] == "hum")
    assert (hum["verdict"], hum["unit"]) == ("warn", "dB")
    assert hum["value"] == pytest.approx(-55.3, abs=0.3)
    assert (tmp_path / "d.html").is_file()


def test_a_failed_verdict_is_status_1_with_what_to_do(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    spoil(monkeypatch, lambda _, recorded: recorded[:, 2].fill(0.0))
    assert call(monkeypatch, "--json", "-") == 1
    streams = capsys.readouterr()
    assert json.loads(streams.out)["verdict"] == "fail"
    assert "loopback: put a cable from output 3 to input 3" in streams.err


def test_a_zip_holds_what_an_issue_needs_and_no_private_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    private = ("--set", "rig.name=Adas basement", "--set", f"daemon.data={tmp_path}/secret")
    assert call(monkeypatch, "--report", tmp_path / "d.zip", *private) == 0
    said = capsys.readouterr().out
    with zipfile.ZipFile(tmp_path / "d.zip") as archive:
        parts = {name: archive.read(name).decode() for name in archive.namelist()}
    assert set(parts) == {"README.txt", "rig.toml", "verdicts.json", "machine.json", "devices.json"}
    assert all(f"  {name}: " in said for name in parts if name != "README.txt")
    assert not [name for name, text in parts.items() if "basement" in text or "secret" in text]
    settings = tomllib.loads(parts["rig.toml"])
    assert (settings["rig"]["name"], settings["audio"]["rate"]) == ("<rig.name>", 44_100)
    assert settings["simulator"]["plant"] == "vibrator"
    assert [each["check"] for each in json.loads(parts["verdicts.json"])][:2] == ["card", "recordings"]
    assert json.loads(parts["machine.json"])["libraries"]["numpy"] == np.__version__


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--set", "limits.peak=11"], "limits.peak is 11 V, must be <= audio.output_full_scale, 10 V"),
        (["--set", "reference.signal=chirp:40"], "reference 'chirp:40' is not chirp:F0:F1:SECONDS"),
        (["--report", "d.pdf"], "--report is d.pdf, must end in .html or .zip"),
        (["--report", "/nowhere/d.html"], "--report /nowhere/d.html cannot be: /nowhere is no folder"),
    ],
)
def test_what_cannot_be_examined_is_one_line_and_status_2(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    assert call(monkeypatch, *arguments) == 2
    errors = [line for line in capsys.readouterr().err.splitlines() if line.startswith("error")]
    assert len(errors) == 1
    assert words in errors[0]


def test_ctrl_c_ramps_down_and_ends_with_a_word(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    played: list[np.ndarray] = []
    spoil(monkeypatch, lambda out, _: played.append(out.copy()))
    serve, calls = Engine.serve, [0]

    def interrupted(self: Engine) -> None:
        calls[0] += 1
        if sum(map(len, played)) > 17 * 44_100 and played[-1][:, :2].any() and calls[0] > 0:
            calls[0] = -1_000
            raise KeyboardInterrupt
        serve(self)

    monkeypatch.setattr(Engine, "serve", interrupted)
    assert call(monkeypatch) == 130
    assert "stopped; every output is ramped down to zero" in capsys.readouterr().err
    drives = np.concatenate(played)[:, :2]
    assert np.abs(drives).max() > 0.01
    assert not drives[-512:].any()
    assert np.abs(np.diff(drives, axis=0)).max() * 10 * 44_100 < 20_000
