"""Joints come out of what a procedure has recorded, also where it was killed, and no half-moved one does."""

from pathlib import Path

import numpy as np
import pytest

from calibration.joint_clamping.recorded_joints import missing, next_procedure, read, take_out
from ctlblocks import recording
from ctlblocks.recording import Recording

NAMES = ("angle_1", "torque_1", "frames_1", "fault", "clamp", "soft", "joint")


def procedure(folder: Path, name: str, soft: list[float], joint: list[float], torque: float = 0.0) -> None:
    """Write what was recorded of a procedure that was clamped from its first joint on, and to its end."""
    rows = len(joint)
    data = np.zeros((rows, len(NAMES)))
    data[:, 0], data[:, 1] = np.arange(rows), torque
    data[:, -3], data[:, -2], data[:, -1] = soft, soft, joint
    recording.write(folder / f"{name}.wav", Recording(NAMES, ("1",) * len(NAMES), 250.0, data))


def test_only_joints_that_the_procedure_went_on_from_are_taken_out(tmp_path: Path) -> None:
    procedure(tmp_path, "clamping-1", [0, 0, 1, 1, 1, 1, 1, 1, 1], [0, 0, 0, 3, 3, 0, 1, 1, 1])
    take_out(tmp_path)
    assert missing(tmp_path, [0, 1, 2]) == (0, 1)
    found, way = read(tmp_path, [2])
    assert found[2].names == ("angle_1", "torque_1", "frames_1")
    assert found[2].data[:, 0].tolist() == [3, 4]
    assert way is not None
    assert way.data[:, 0].tolist() == [0, 1]


def test_the_next_procedure_brings_what_is_missing_and_nothing_twice(tmp_path: Path) -> None:
    procedure(tmp_path, "clamping-1", [0, 1, 1, 1, 0], [0, 0, 2, 2, 0], torque=1.0)
    take_out(tmp_path)
    assert next_procedure(tmp_path) == "clamping-2"
    procedure(tmp_path, "clamping-2", [0, 0, 1, 1, 1, 0], [0, 0, 2, 2, 1, 0], torque=2.0)
    take_out(tmp_path)
    found, way = read(tmp_path, [0, 1])
    assert [found[joint].data[0, 1] for joint in (0, 1)] == [2.0, 1.0]
    assert way is not None
    assert len(way.data) == 2


def test_recordings_of_joints_alone_are_read_as_before(tmp_path: Path) -> None:
    recording.write(tmp_path / "joint-1.wav", Recording(("angle_1",), ("rad",), 250.0, np.ones((3, 1), np.float32)))
    take_out(tmp_path)
    found, way = read(tmp_path, [0])
    assert found[0].data.sum() == 3
    assert way is None


@pytest.mark.parametrize("joint", [[0, 1, 1, 1], [0, 1, 1, 0]])
def test_a_joint_that_was_not_moved_to_its_end_gives_none(tmp_path: Path, joint: list[float]) -> None:
    """Killed in it; or aborted: the procedure moves none any more, and leaves the clamp closed."""
    procedure(tmp_path, "clamping-1", [0, 1, 1, 1], joint)
    take_out(tmp_path)
    assert missing(tmp_path, [0]) == (0,)
    with pytest.raises(recording.RecordingError):
        read(tmp_path, [0])
