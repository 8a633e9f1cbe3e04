"""The command line: what a person types, and what comes of mistakes."""

import json
import sys
from pathlib import Path

import pytest

from rigkit import config as rig_file
from stagectl.__main__ import main
from stagectl.config import StageConfig
from tests.stagectl.experiments.piezo.simulated_models import write_models

QUICK = ["--set", "session.recording=wav", "--set", "session.lead=0.6", "--set", "outer.mistuning=0.0"]


def stagectl(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["stagectl", *words])
    return main()


def test_the_example_is_a_rig_file_of_all_defaults(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert stagectl(monkeypatch, "example-config") == 0
    file = tmp_path / "stage.toml"
    file.write_text(capsys.readouterr().out)
    assert rig_file.load(file, StageConfig, as_written=True) == StageConfig()


def test_a_run_ends_with_a_table_figures_and_a_report_and_can_be_replayed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    models = [word for file in write_models(tmp_path) for word in ("--model", str(file))]
    run, figures = str(tmp_path / "run"), str(tmp_path / "figures.json")
    assert stagectl(monkeypatch, "run", "--out", run, *models, *QUICK, "--seconds", "0.3", "--json", figures) == 0
    assert json.loads(Path(figures).read_text())["position_error"]["x"]["mae"] < 0.2e-6
    assert "within 5 um" in capsys.readouterr().out
    assert stagectl(monkeypatch, "replay", run) == 0
    assert "yes" in capsys.readouterr().out
    assert (tmp_path / "run" / "report.html").exists()


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--set", "limits.ramp=0.3"], "there are 0 model files, must be one for each of the axes x, y, z"),
        (["--set", "limits.travel=[2e-4, 1e-4]"], "limits.travel is 0.0002 to 0.0001, must rise"),
        (["--set", "session.lead=0.1"], "session.lead is 0.1 s, must be >= 0.5 s"),
        (["--set", "outer.drive=[1, 2]"], "outer.drive is (1.0, 2.0), must be 1 or 3 numbers > 0"),
        (["--set", "outer.bandwith=3"], "bandwidth"),
        (["--scenario", "turning"], "scenario is 'turning', must be one of milling-x, milling-y, milling-z"),
        (["--live", "--scenario", "turning"], "scenario is 'turning', must be one of milling-x"),
        (["--live", "--set", "link.channel=/dev/ttyNONE"], "cannot open link.channel '/dev/ttyNONE'"),
    ],
)
def test_a_mistake_is_one_line_and_status_2_and_leaves_no_folder(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path, words: list[str], text: str
) -> None:
    assert stagectl(monkeypatch, "run", "--out", str(tmp_path / "run"), *words) == 2
    assert text in capsys.readouterr().err
    assert not (tmp_path / "run").exists()


def test_a_plant_that_is_none_is_refused_by_name(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    models = [word for file in write_models(tmp_path) for word in ("--model", str(file))]
    wrong = ["--set", "simulator.options={seeds = 3}"]
    assert stagectl(monkeypatch, "run", "--out", str(tmp_path / "run"), *models, *QUICK, *wrong) == 2
    assert "firmware_sim.stage_blocks:PiezoStage does not take these options" in capsys.readouterr().err


def test_a_folder_that_is_no_run_is_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    for command in ("replay", "report"):
        assert stagectl(monkeypatch, command, str(tmp_path)) == 2
        assert "is not the folder of a run: it has no config.toml" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("settings", "text"),
    [
        (["deflection.on=true", "laser.rate=1000"], "deflection.corner is 2000 Hz, must be > 0 and <= 400 Hz"),
        (
            ["laser.on=true", "link.bitrate=500000", "link.data_bitrate=2000000"],
            "link.bitrate is 500000 bit/s with link.form fd, must be faster to read lasers over it",
        ),
        (["deflection.on=true", "deflection.prefilter=p.json"], "p.json"),
    ],
)
def test_what_the_lasers_of_a_live_run_cannot_do_is_refused_and_not_passed_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], settings: list[str], text: str
) -> None:
    out = tmp_path / "run"
    words = [word for each in settings for word in ("--set", each)]
    assert stagectl(monkeypatch, "run", "--live", *words, "--out", str(out)) == 2
    assert text in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize(
    ("settings", "text"),
    [
        (
            ["simulator.options={laser_rate=1000.0}"],
            "simulator.options.laser_rate is 1000 Hz, must be laser.rate, 5000 Hz",
        ),
        (["laser.rate=1000", "deflection.corner=400"], "deflection.delay is 2 samples, must be >= 10"),
        (["laser.rate=1000"], "deflection.corner is 2000 Hz, must be > 0 and <= 400 Hz with a laser of 1000"),
    ],
)
def test_a_laser_too_slow_for_its_compensation_is_refused_in_process_as_well(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], settings: list[str], text: str
) -> None:
    out = tmp_path / "run"
    models = [word for file in write_models(tmp_path) for word in ("--model", str(file))]
    words = [word for each in ["deflection.on=true", *settings] for word in ("--set", each)]
    assert stagectl(monkeypatch, "run", *models, *QUICK, *words, "--out", str(out)) == 2
    assert text in capsys.readouterr().err
    assert not out.exists()
