"""The rig is compared with its model: what nothing else can tell, such as that all wires were swapped, is found."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from rigkit import config as rig_file
from rigkit.verdict import Verdict
from tests.vibractl.doctor.doctor_rig import SIDES, measured, verdict, wired
from vibractl.__main__ import main
from vibractl.doctor.calibrated import MODEL
from vibractl.doctor.examination import examine
from vibractl.model_file import write_model


def said(place: Path, sides: np.ndarray) -> Verdict:
    return verdict(examine(wired(place, sides), model=measured()), MODEL)


@pytest.mark.usefixtures("brief")
def test_a_rig_as_it_was_calibrated_passes(tmp_path: Path) -> None:
    found = said(tmp_path, SIDES)
    assert (found.grade, found.advice) == ("pass", "")
    assert found.value < 0.05


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("sides", "text"),
    [
        (SIDES * [1, -1], "drive 2 is turned round (its polarity)"),
        (SIDES * [[1], [-1]], "response 2 is turned round (its polarity)"),
        (-SIDES, "every "),
        (SIDES[::-1], "response 1 is where response 2 was; response 2 is where response 1 was"),
        (SIDES[:, ::-1], "drive 1 is where drive 2 was; drive 2 is where drive 1 was"),
        (SIDES * 0.5, "is 0.5 times as large"),
        (SIDES * [[2], [1]], "response 1 is 2 times as large"),
    ],
    ids=["coil turned", "sensor turned", "all turned", "sensors", "coils", "half", "sensor doubled"],
)
@pytest.mark.usefixtures("brief")
def test_what_was_changed_since_is_named(tmp_path: Path, sides: np.ndarray, text: str) -> None:
    found = said(tmp_path, sides)
    assert found.grade == "fail"
    assert text in found.measured
    assert "measure a new model" in found.advice


@pytest.mark.usefixtures("brief")
def test_a_machine_of_which_the_model_says_nothing_is_a_warning(tmp_path: Path) -> None:
    found = said(tmp_path, np.array([[10.0, -6.0], [7.0, 8.0]]))
    assert found.grade == "warn"
    assert "by no change of channels" in found.measured


def test_at_the_command_line_the_check_is_one_more(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    config = wired(tmp_path, -SIDES)
    (tmp_path / "rig.toml").write_text(rig_file.dump(config))
    write_model(tmp_path / "model.h5", measured().described(rig=config.rig.name))
    words = ["doctor", "--config", "rig.toml", "--model", "model.h5", "--json", "doctor.json"]
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["vibractl", *words])
    assert main() == 1
    assert "set it right, or measure a new model" in capsys.readouterr().out
    checks = json.loads((tmp_path / "doctor.json").read_text())["checks"]
    assert [each["verdict"] for each in checks if each["check"] == MODEL] == ["fail"]
    monkeypatch.setattr(sys, "argv", ["vibractl", "doctor", "--model", "no.h5"])
    assert main() == 2
    assert "no.h5" in capsys.readouterr().err
