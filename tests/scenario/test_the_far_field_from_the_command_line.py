"""The rig file for a vibrator in water, from printing it to the report: what a newcomer types.

Guards against a step that forgets the hydrophone: the card, the model, the objective, the report, the export.
"""

import contextlib
import io
import json
from collections.abc import Callable
from pathlib import Path

import pytest

from calibration.__main__ import main as calibrate
from vibractl.__main__ import main as vibractl

pytestmark = pytest.mark.slow
BRIEF = ("--set", "audio.isolated=false", "--set", "reference.signal=chirp:30:75:2")
SHORT = ("--set", "characterisation.period=2.0", "--set", "characterisation.records=5", *BRIEF)


def call(program: Callable[[], int], *words: str) -> str:
    """Run a command that must succeed, and return what it printed."""
    with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stdout(io.StringIO()) as said:
        patch.setattr("sys.argv", ["program", *words])
        assert program() == 0
    return said.getvalue()


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the rig file of the preset and a model measured with it."""
    place = tmp_path_factory.mktemp("rig")
    (place / "rig.toml").write_text(call(vibractl, "example-config", "--preset", "underwater"))
    words = ("--config", f"{place}/rig.toml", "--out", f"{place}/m.h5", "--json", f"{place}/m.json")
    assert "far field" in call(calibrate, "vibrator", *words, *SHORT)
    return place


@pytest.fixture(scope="module")
def run(place: Path) -> Path:
    """Return the folder of a run of one shot."""
    words = ("--config", f"{place}/rig.toml", "--model", f"{place}/m.h5", "--shots", "1", "--out", f"{place}/RUN")
    call(vibractl, "run", *words, *BRIEF)
    return place / "RUN"


def test_the_calibration_finds_how_late_the_hydrophone_hears(place: Path) -> None:
    delay = json.loads((place / "m.json").read_text())["far_field"]["delay_seconds"]
    assert delay == [pytest.approx(10 / 1500, abs=0.001)]
    assert "Far field" in (place / "m.html").read_text()
    assert "far field" in call(calibrate, "compare", f"{place}/m.h5", f"{place}/m.h5")


def test_the_run_is_judged_by_the_hydrophone(run: Path) -> None:
    figures = json.loads((run / "summary.json").read_text())
    assert figures["judged"] == "far-field"
    assert set(figures["places"]) == {"accelerometers", "far-field"}
    assert "At the accelerometers, beside that" in (run / "report.html").read_text()


def test_the_report_is_drawn_again_and_the_far_field_exported(run: Path) -> None:
    (run / "report.html").unlink()
    call(vibractl, "report", str(run))
    assert "Objective, -40 dB in the far field" in (run / "report.html").read_text()
    call(vibractl, "export", str(run), "--format", "csv")
    assert (run / "export/far-field.csv").is_file()


def test_there_is_no_other_preset(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("sys.argv", ["vibractl", "example-config", "--preset", "space"])
    assert vibractl() == 2
    assert "--preset is 'space', must be underwater" in capsys.readouterr().err
