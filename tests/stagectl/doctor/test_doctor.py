"""`stagectl doctor`: how late the machine wakes, against what a cell's and a stage's files allow."""

import json
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest

from stagectl.__main__ import main
from stagectl.config import StageConfig
from stagectl.doctor.examination import examined
from stagectl.doctor.wake_up import WakeUps, wake_ups
from stagectl.robot.config import CellConfig


class Machine:
    """A clock, and sleep that is late by turns."""

    def __init__(self, late: list[float]) -> None:
        self.time, self._late = 0.0, late
        self._count = 0

    def now(self) -> float:
        return self.time

    def sleep(self, seconds: float) -> None:
        self.time += seconds + self._late[self._count % len(self._late)]
        self._count += 1


def seen(worst: float) -> WakeUps:
    late = np.full(10_000, 1e-4)
    late[77] = worst
    return WakeUps(late, 1e-3)


def test_lateness_is_that_of_each_moment_that_was_waited_for() -> None:
    machine = Machine([1e-4, 3e-4])
    found = wake_ups(1e-3, 0.1, now=machine.now, sleep=machine.sleep)
    assert found.late == pytest.approx(np.tile([1e-4, 3e-4], 50))
    assert found.worst == pytest.approx(3e-4)
    assert found.beyond(2e-4) == 50


def test_a_stall_makes_all_that_was_due_in_it_late() -> None:
    machine = Machine([0.0, 0.0, 5e-3, *[0.0] * 97])
    found = wake_ups(1e-3, 0.02, now=machine.now, sleep=machine.sleep)
    assert found.late[2:8] == pytest.approx([5e-3, 4e-3, 3e-3, 2e-3, 1e-3, 0.0])


@pytest.mark.parametrize(
    ("worst", "verdicts"),
    [
        (1e-3, {"the robot's cycle": "pass", "the force sensor": "pass"}),
        (8e-3, {"the robot's cycle": "warn", "the force sensor": "pass"}),
        (35e-3, {"the robot's cycle": "fail", "the force sensor": "fail"}),
    ],
)
def test_each_limit_is_judged_by_the_worst(worst: float, verdicts: dict[str, str]) -> None:
    found = {each.check: each for each in examined(seen(worst), CellConfig(), StageConfig(), True)}
    assert {check: found[check].grade for check in verdicts} == verdicts
    assert found["real-time priority"].grade == "pass"
    if worst > 12e-3:
        assert "robot.silence = 18" in found["the robot's cycle"].advice  # cycles of 4 ms: twice 35 ms
        assert "1 of 10000 beyond the limit" in found["the robot's cycle"].measured


def test_what_is_not_granted_is_said() -> None:
    found = examined(seen(1e-3), CellConfig(), StageConfig(), False)
    assert [each.check for each in found if each.grade == "warn"][0] == "real-time priority"


def doctor(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["stagectl", "doctor", *words])
    return main()


def test_the_command_judges_this_machine(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    figures = tmp_path / "found.json"
    patient = ("--set", "robot.silence=250", "--set", "force_sensor.silence=10")
    assert doctor(monkeypatch, "--seconds", "0.5", *patient, "--json", str(figures)) in (0, 1)
    found = json.loads(figures.read_text())
    assert {each["check"] for each in found["checks"]} >= {"the robot's cycle", "the stage's link"}


def test_a_mistake_is_one_line(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    assert doctor(monkeypatch, "--seconds", "0") == 2
    assert "--seconds is 0, must be 0.5 to 3600" in capsys.readouterr().err


def test_a_zip_holds_what_an_issue_needs_and_no_private_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["stagectl", "doctor", "--seconds", "0.5", "--report", str(tmp_path / "d.zip"), "--json", "-"]
    monkeypatch.setattr(sys, "argv", [*words, "--set", "robot.address=10.1.2.3"])
    main()  # its verdict is of the machine that it runs on
    assert "d.zip holds:" in capsys.readouterr().err
    with zipfile.ZipFile(tmp_path / "d.zip") as archive:
        parts = {name: archive.read(name).decode() for name in archive.namelist()}
    assert {"cell.toml", "stage.toml", "verdicts.json", "machine.json", "devices.json"} < set(parts)
    assert 'address = "<robot.address>"' in parts["cell.toml"]
    assert not [name for name, text in parts.items() if "10.1.2.3" in text]


def test_a_report_of_another_kind_is_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["stagectl", "doctor", "--report", "d.html"])
    assert main() == 2
    assert "--report is d.html, must end in .zip" in capsys.readouterr().err
