"""What of a file of joint models a path carries: joints that are known, and cross their backlash."""

from pathlib import Path

import numpy as np
import pytest

from calibration.joint_clamping import joints_file
from calibration.output import provenance
from rigkit.agreement import DisagreementError
from rigkit.model_file import ModelFile, ModelFileError, write_model_file
from stagectl.models.joint_backlash import FIGURES, FORMAT, lost_motion
from stagectl.robot.config import CellConfig

CELL = CellConfig()
WEIGHT = np.tile([0.0, -90.0, -43.0, 0.1, 0.2, 0.0], (10, 1))
"""N m, at home."""
STIFFNESS, FRICTION = 4e4, 8.0


def written(path: Path, gaps: list[tuple[float, float]], cell: CellConfig = CELL, **changed: np.ndarray) -> Path:
    """Write a file of as many joints, each with its backlash and half of its interval, rad."""
    count = len(gaps)

    def figure(value: float, half: float) -> np.ndarray:
        return np.tile([value, half / 2.0, 2.0], (count, 1))

    arrays = {
        "joint": np.arange(1, count + 1),
        "has_backlash": np.ones(count, int),
        "backlash": np.array([[value, half / 2.0, 2.0] for value, half in gaps]),
        "k_plus": figure(STIFFNESS, 100.0), "k_minus": figure(STIFFNESS, 100.0), "friction": figure(FRICTION, 0.5),
    }  # fmt: skip
    words = provenance(cell, "2026-01-01T00:00:00+00:00", {})
    write_model_file(path, ModelFile(FORMAT, arrays | changed, provenance=words))
    return path


def test_it_reads_what_calibrate_joints_writes() -> None:
    assert FORMAT == joints_file.FORMAT
    assert set(FIGURES) <= set(joints_file.ESTIMATES)


def test_half_the_backlash_and_the_wind_up_of_joints_that_carry_no_weight(tmp_path: Path) -> None:
    notes: list[str] = []
    found = lost_motion(written(tmp_path / "j.h5", [(2e-4, 1e-5)] * 6), CELL, WEIGHT, (), notes.append)
    assert found is not None
    wound = 1e-4 + FRICTION / STIFFNESS
    np.testing.assert_allclose(found.half, [wound, 0.0, 0.0, wound, wound, wound])
    assert notes == [
        f"{tmp_path}/j.h5: joint 2 is left out: gravity holds it to one side with 90 N m or more, its friction is 8",
        f"{tmp_path}/j.h5: joint 3 is left out: gravity holds it to one side with 43 N m or more, its friction is 8",
    ]


def test_a_backlash_within_its_interval_is_left_out_and_nothing_may_be_left(tmp_path: Path) -> None:
    notes: list[str] = []
    file = written(tmp_path / "j.h5", [(2e-5, 3e-5)])
    assert lost_motion(file, CELL, WEIGHT, (), notes.append) is None
    assert notes == [f"{file}: joint 1 is left out: its backlash is 0.020 ± 0.030 mrad, must be more than its interval"]


def test_friction_that_is_not_known_winds_nothing_up(tmp_path: Path) -> None:
    unknown = np.array([[FRICTION, FRICTION, 2.0]])
    found = lost_motion(written(tmp_path / "j.h5", [(2e-4, 1e-5)], friction=unknown), CELL, WEIGHT, (), str)
    assert found is not None
    assert found.half[0] == pytest.approx(1e-4)


def test_a_file_of_another_robot_is_refused(tmp_path: Path) -> None:
    other = CellConfig(robot=CELL.robot.model_copy(update={"arm": "kuka"}))
    file = written(tmp_path / "j.h5", [(2e-4, 1e-5)], other)
    with pytest.raises(DisagreementError, match="was measured on a cell that was wired otherwise"):
        lost_motion(file, CELL, WEIGHT, (), str)


@pytest.mark.parametrize(
    ("changed", "text"),
    [
        ({"joint": np.array([7])}, r"its joints are \[7\], must be of 1 to 6"),
        ({"backlash": np.full((1, 3), np.nan)}, r"backlash has shape \(1, 3\), must be \(1, 3\) of finite numbers"),
        ({"friction": np.zeros((2, 3))}, r"friction has shape \(2, 3\), must be \(1, 3\)"),
    ],
)
def test_figures_that_are_none_are_refused(tmp_path: Path, changed: dict[str, np.ndarray], text: str) -> None:
    with pytest.raises(ModelFileError, match=text):
        lost_motion(written(tmp_path / "j.h5", [(2e-4, 1e-5)], **changed), CELL, WEIGHT, (), str)
