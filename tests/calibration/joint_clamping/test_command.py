import json
import sys
from pathlib import Path

import numpy as np
import pytest

from calibration.__main__ import main
from calibration.joint_clamping.command import joint_numbers
from calibration.joint_clamping.joints_file import read_joints
from calibration.joint_clamping.report import HEAD, rows
from calibration.joint_clamping.results import LINK, RAW, TOOL, of_map
from calibration.joint_clamping.session import KEPT, KIND, Desk, measure
from calibration.joint_clamping.torque_map import TorqueMap
from calibration.names import OutputError
from calibration.output import Wish, output
from calibration.raw_run import raw_run
from rigkit.config import load
from rigkit.experiment.kept import records_of
from rigkit.experiment.once import PartEnded
from rigkit.experiment.runner import Conduct
from rigkit.model_file import ModelFileError
from rigkit.stop import Stopped
from stagectl.robot.config import CellConfig
from tests.calibration.joint_clamping.clamped_arm import RATE, ClampedArm, random_joints, to_and_fro

STOPPED = Desk(print, Conduct(lambda: True))
QUICK = ("clamping.cycles=2", f"clamping.speed=[{', '.join(['0.05'] * 6)}]", "clamping.settle=0.04")


def call(monkeypatch: pytest.MonkeyPatch, folder: Path, *arguments: str) -> int:
    monkeypatch.chdir(folder)
    monkeypatch.setattr(sys, "argv", ["calibrate", "joints", *arguments])
    return main()


def test_a_recorded_map_gives_a_model_a_report_and_figures(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    parts = random_joints(2)
    arm = ClampedArm(parts)
    angle, torque, _ = arm.run(to_and_fro(arm, 2))
    table = np.column_stack([np.arange(len(angle)) / RATE, 100 * angle[:, 2], torque[:, 2] / 100])
    np.savetxt(tmp_path / "map.csv", table, delimiter=",", header="time,phi [rad],tau [N m]", comments="", fmt="%.9g")
    options = ("--from", "map.csv", "--angle", "phi", "--torque", "tau", "--gear", "100", "--out", "joint.h5")
    assert call(monkeypatch, tmp_path, *options, "--png", "png", "--json", "figures.json") == 0
    figures = json.loads((tmp_path / "figures.json").read_text())["joint_1"]["as measured"]
    assert figures["k_plus"] == pytest.approx(parts.k_plus[2], rel=0.01)
    low, high = figures["backlash_interval"]
    assert low - 2e-6 < parts.backlash[2] < high + 2e-6
    model = read_joints(tmp_path / "joint.h5")[0]
    assert model.k_plus.value == figures["k_plus"]
    assert model.has_backlash
    assert (tmp_path / "joint.html").exists()
    assert (tmp_path / "png" / "joint-1.png").exists()


def test_a_dry_run_prints_every_motion_and_makes_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, tmp_path, "--joints", "1,3-4", "--dry-run") == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 3 + 3 + 1 + 3 + 3
    assert "joint 4, 5 cycles: to +-20 N m" in lines[9]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_the_simulated_arm_is_measured_from_the_command_line_and_not_twice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Seed 1, joint 3: play of a fiftieth of the span."""
    options = [part for text in QUICK for part in ("--set", text)]
    files = ("--out", "joints.h5", "--json", "figures.json")
    assert call(monkeypatch, tmp_path, "--joints", "3", *files, *options) == 0
    found = json.loads((tmp_path / "figures.json").read_text())["joint_3"]
    raw, flange, link = (found[way]["k_plus"] for way in (RAW, TOOL, LINK))
    assert raw < flange < link
    assert link == pytest.approx(52_478.3, rel=0.03)
    assert found[LINK]["has_backlash"]
    assert found[LINK]["backlash"] == pytest.approx(0.0862e-3, abs=0.02e-3)
    assert (tmp_path / "joints.raw" / "maps.html").exists()
    before = (tmp_path / "joints.raw" / "joint-3.wav").stat().st_mtime_ns
    config = load(None, CellConfig, QUICK)
    with raw_run(tmp_path / "joints.raw", config) as folder:
        measure(config, (2,), folder, STOPPED)
    assert (tmp_path / "joints.raw" / "joint-3.wav").stat().st_mtime_ns == before
    with pytest.raises(OutputError, match=r"joints.h5: was measured on .* and is finished; --again"):
        output(tmp_path / "joints.h5", KIND, config, Wish(), use=KEPT)
    assert call(monkeypatch, tmp_path, "--joints", "3", *files, *options) == 2
    assert call(monkeypatch, tmp_path, "--joints", "3", "--recompute", "--out", "joints.h5") == 0
    assert (tmp_path / "joints.raw" / "joint-3.wav").stat().st_mtime_ns == before


def test_an_abort_says_why_and_a_stop_where_it_stands(tmp_path: Path) -> None:
    slipping = CellConfig.model_validate({"simulator": {"slip": 40.0}})
    with (
        raw_run(tmp_path / "one", slipping) as folder,
        pytest.raises(PartEnded, match=r"(slips|is it clamped).*; the arm holds in step 4"),
    ):
        measure(slipping, (0,), folder, Desk(lambda _: None))
    assert records_of(tmp_path / "one")["clamping-1"].data.any()
    with (
        raw_run(tmp_path / "two", CellConfig()) as folder,
        pytest.raises(Stopped, match="stopped in step 1: the arm holds"),
    ):
        measure(CellConfig(), (0,), folder, STOPPED)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (("simulator.options.backlash=-1",), "simulator.options.backlash is -1, must be"),
        (("clamping.live=true",), r"robot.commands is 0 and robot.signals 0, must be ports"),
        (("clamping.live=true", "robot.wire=rsi"), "robot.wire is rsi, whose messages carry no soft servo"),
    ],
)
def test_what_cannot_begin_leaves_no_folder(tmp_path: Path, settings: tuple[str, ...], message: str) -> None:
    cell = load(None, CellConfig, ["robot.commands=0", "robot.signals=0", *settings])
    with pytest.raises(ValueError, match=message), raw_run(tmp_path / "raw", cell) as folder:
        measure(cell, (0,), folder, Desk(print))
    assert not (tmp_path / "raw").exists()


def test_a_file_that_holds_no_joints_is_refused(tmp_path: Path) -> None:
    (tmp_path / "joints.h5").write_bytes(b"no")
    with pytest.raises(ModelFileError):
        read_joints(tmp_path / "joints.h5")


@pytest.mark.parametrize(("text", "numbers"), [("1-6", (0, 1, 2, 3, 4, 5)), ("6, 2-3,2", (5, 1, 2))])
def test_joints_are_numbers_and_ranges(text: str, numbers: tuple[int, ...]) -> None:
    assert joint_numbers(text, 6) == numbers


@pytest.mark.parametrize("text", ["0", "1-7", "3-2", "x", "", "1;2"])
def test_other_joints_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match="must be a number or a range from 1 to 6"):
        joint_numbers(text, 6)


def test_the_table_says_what_is_not_significant() -> None:
    parts = random_joints(0, backlash=False)
    arm = ClampedArm(parts)
    angle, torque, _ = arm.run(to_and_fro(arm, 0, cycles=3))
    (row,) = rows([of_map(TorqueMap(angle[:, 0], torque[:, 0], RATE), {})])
    assert len(row) == len(HEAD)
    assert row[3].startswith("not significant (< 0.0")
