"""Forces from a signal logger's file: what is in it, what is not, and what it cannot be."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from rigkit.model_file import ModelFile, write_model_file
from stagectl.__main__ import main
from stagectl.robot.kinematics import jacobian
from stagectl.robot.milling.torque_file import FORMAT, UNITS, torque_arrays
from stagectl.robot.milling.torque_log import NAMES, TorqueLogError, read_torque_log
from tests.stagectl.robot.milling.torque_models import ARM, INERTIA, some_gravity, wide_friction

RATE, SAMPLES = 250.0, 500
FORCE = np.array([30.0, -20.0, 10.0])


def a_log() -> np.ndarray:
    """Return time (s), angles (deg) and torques (N m) of a slow motion under a steady force, friction in the middle."""
    time = 3.0 + np.arange(SAMPLES) / RATE
    angle = np.radians([10.0, 10.0, -15.0, 20.0, 40.0, 10.0]) + 0.05 * np.sin(time[:, None] + np.arange(6))
    torque = some_gravity().torque(ARM, angle) - FORCE @ jacobian(ARM, angle)[:, :3]
    return np.column_stack([time, np.degrees(angle), torque])


def write_log(path: Path, rows: np.ndarray, head: str = "") -> None:
    lines = [",".join("" if np.isnan(cell) else f"{cell:.10g}" for cell in row) for row in rows]
    path.write_text(head + "\n".join(lines) + "\n")


@pytest.fixture
def call(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):  # type: ignore[no-untyped-def] # noqa: ANN201
    friction = wide_friction(0.5, smoothing=0.0)
    arrays = torque_arrays(friction, some_gravity(), INERTIA)
    write_model_file(tmp_path / "milling.h5", ModelFile(FORMAT, arrays, UNITS))
    monkeypatch.chdir(tmp_path)

    def run(rows: np.ndarray, *options: str, head: str = "") -> int:
        write_log(tmp_path / "log.csv", rows, head)
        words = ["stagectl", "estimate-force", "log.csv", "--model", "milling.h5", "--out", "force.csv", *options]
        monkeypatch.setattr(sys, "argv", words)
        return main()

    return run


def read_force(path: Path) -> np.ndarray:
    return np.genfromtxt(path, delimiter=",", skip_header=1)


def test_a_log_becomes_forces_with_their_bounds(call, tmp_path: Path) -> None:  # type: ignore[no-untyped-def] # noqa: ANN001
    assert call(a_log(), "--json", "figures.json", "--png", "png", head="time,a,b,c,d,e,f,g,h,i,j,k,l\n") == 0
    found = read_force(tmp_path / "force.csv")
    assert found.shape == (SAMPLES, 18)
    assert found[:, 0] == pytest.approx(3.0 + np.arange(SAMPLES) / RATE)
    assert found[:, 1:4] == pytest.approx(np.tile(FORCE, (SAMPLES, 1)), abs=1e-3)
    assert (found[:, 4:7] < FORCE).all()
    assert (found[:, 7:10] > FORCE).all()
    assert (found[:, 4:7] <= found[:, 12:15]).all()
    assert (found[:, 15:18] <= found[:, 7:10]).all()
    figures = json.loads((tmp_path / "figures.json").read_text())
    assert figures["rate"] == pytest.approx(250.0)
    assert figures["by_friction_alone"] == 1.0
    assert figures["x"]["mean"] == pytest.approx(30.0, abs=1e-3)
    assert (tmp_path / "png" / "force.png").stat().st_size > 10_000


def test_gaps_are_left_empty_and_said(call, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:  # type: ignore[no-untyped-def] # noqa: ANN001
    """Lines that are missing, and a cell without a number."""
    rows = a_log()
    rows[300, 9] = np.nan
    assert call(np.delete(rows, slice(100, 125), axis=0)) == 0
    found = read_force(tmp_path / "force.csv")
    assert len(found) == SAMPLES
    empty = np.isnan(found[:, 1])
    assert list(np.flatnonzero(empty)) == [*range(100, 125), 300]
    assert found[~empty, 1:4] == pytest.approx(np.tile(FORCE, (SAMPLES - 26, 1)), abs=1e-3)
    assert "2 gaps, 26 samples, 0.104 s in all, are left empty" in capsys.readouterr().out


def test_a_joint_faster_than_friction_is_known_is_said(call, capsys: pytest.CaptureFixture[str]) -> None:  # type: ignore[no-untyped-def] # noqa: ANN001
    rows = a_log()
    rows[250:, 6] += 1.0
    assert call(rows) == 0
    assert "1 samples give no force: a joint is faster than friction is known" in capsys.readouterr().out


def wrong(change: object) -> np.ndarray:
    rows = a_log()
    change(rows)  # type: ignore[operator]
    return rows


def radians(rows: np.ndarray) -> None:
    rows[:, 1:7] = np.radians(rows[:, 1:7])


def in_motor_units(rows: np.ndarray) -> None:
    rows[:, 7:] *= 1e3


def reversed_signs(rows: np.ndarray) -> None:
    rows[:, 7:] *= -1.0


def one_sign(rows: np.ndarray) -> None:
    rows[:, 8] *= -1.0


def no_torques(rows: np.ndarray) -> None:
    rows[:, 7:] = 0.0


def back(rows: np.ndarray) -> None:
    rows[17, 0] = rows[15, 0]


def uneven(rows: np.ndarray) -> None:
    rows[20:, 0] += 0.002


def late(rows: np.ndarray) -> None:
    rows[20:, 0] += 12.0


def far(rows: np.ndarray) -> None:
    rows[7, 2] = 140.0


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (radians, "log.csv: all angles are within +-6.28, are they in deg or in rad? Say --angles deg or rad"),
        (in_motor_units, "N m off what holds the arm up, its friction is at most 8 N m: torques must be in N m"),
        (reversed_signs, "the torque's sign appears reversed, of joint 2, 3, 4, 5, 6: it is -"),
        (one_sign, "the torque's sign appears reversed, of joint 2: it is -"),
        (no_torques, "times what holds the arm up: there are none, or they are in other units"),
        (back, "log.csv: row 18: time goes from 3.064 to 3.06 s, must rise"),
        (uneven, "log.csv: row 21: time goes on by 0.006 s, must by whole samples of 0.004 s"),
        (late, "log.csv: row 21: a gap of 12 s, must be <= 10 s; split the log there"),
        (far, "log.csv: joint 2 is at 140 deg, must be -90 to 110; angles are read in deg"),
    ],
)
def test_a_log_that_cannot_be_is_refused_in_one_line(  # type: ignore[no-untyped-def]
    call, change: object, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]  # noqa: ANN001
) -> None:  # fmt: skip
    assert call(wrong(change)) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line
    assert not (tmp_path / "force.csv").exists()


def test_radians_are_read_where_they_are_said(call, tmp_path: Path) -> None:  # type: ignore[no-untyped-def] # noqa: ANN001
    assert call(wrong(radians), "--angles", "rad") == 0
    assert read_force(tmp_path / "force.csv")[:, 1] == pytest.approx(np.full(SAMPLES, 30.0), abs=1e-3)


def test_columns_of_a_log_go_by_their_names_among_others_with_the_unit_of_the_angles(  # type: ignore[no-untyped-def]
    call, tmp_path: Path  # noqa: ANN001
) -> None:  # fmt: skip
    """The robot's log of a trial, as `stagectl ilc` keeps it, has references behind the torques, and radians."""
    rows = wrong(radians)
    mixed = np.column_stack([rows[:, 7:], rows[:, 0], 9 * rows[:, 1:7], rows[:, 1:7]])
    others = [f"reference_{joint} [rad]" for joint in range(1, 7)]
    units = dict.fromkeys(NAMES[1:7], " [rad]") | dict.fromkeys(NAMES[7:], " [N m]")
    names = [f"{name}{units.get(name, '')}" for name in NAMES]
    head = ",".join([*names[7:], names[0], *others, *names[1:7]])
    assert call(mixed, head=f"{head}\n") == 0
    assert read_force(tmp_path / "force.csv")[:, 1] == pytest.approx(np.full(SAMPLES, 30.0), abs=1e-3)


@pytest.mark.parametrize(
    ("units", "said"),
    [
        (["", *["rad"] * 5, "deg", *["N m"] * 6], "units are 'N m', 'deg', 'rad', must be deg or rad for all angles"),
        (["", *["deg"] * 6, *["A"] * 6], "units are 'A', 'deg', must be deg or rad for all angles and N m for all"),
    ],
)
def test_names_with_other_units_are_refused(units: list[str], said: str, tmp_path: Path) -> None:
    head = ",".join(f"{name} [{unit}]" for name, unit in zip(NAMES, units, strict=True))
    write_log(tmp_path / "log.csv", a_log(), head=f"{head}\n")
    with pytest.raises(TorqueLogError, match=said):
        read_torque_log(tmp_path / "log.csv", ARM)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "has 0 samples, must have 3 at least"),
        ("1,2\n", "row 1 has 2 columns, must have 13"),
        ("0" + ",1" * 12 + "\n0.1" + ",1" * 11 + ",x\n", "row 2: 'x' is no number"),
        ("0" + ",1" * 12 + "\n" + ",1" * 12 + "\n", "row 2: 'time' is no number"),
        ("0" + ",1" * 12 + "\ninf" + ",1" * 12 + "\n", "row 2: time must be finite"),
        ("".join(f"{time}{',nan' * 12}\n" for time in (0, 1, 2)), "no sample has all its numbers"),
    ],
)
def test_a_file_that_is_no_log_is_refused_by_row(text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(text)
    with pytest.raises(TorqueLogError, match=said):
        read_torque_log(tmp_path / "log.csv", ARM)


def test_a_file_that_is_not_there_is_said(tmp_path: Path) -> None:
    with pytest.raises(TorqueLogError, match=r"none.csv: No such file or directory"):
        read_torque_log(tmp_path / "none.csv", ARM)
