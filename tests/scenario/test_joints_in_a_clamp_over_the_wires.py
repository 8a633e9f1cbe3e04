"""The clamping procedure over guided motion, the robot's program, its torque signals and the tracker.

Guards against a procedure that works in process alone, and against faults on the way that end without a name or with
the robot pushing on.
"""

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from calibration.joint_clamping import session
from calibration.joint_clamping.aside import Here
from calibration.joint_clamping.extraction import extract
from calibration.joint_clamping.results import map_of, seen_tool, slope_over
from calibration.joint_clamping.session import Desk, measure
from calibration.joint_clamping.tracked_links import link_motion, tracked_axis
from calibration.raw_run import raw_run
from rigkit.experiment.once import PartEnded
from rigkit.experiment.runner import Conduct
from rigkit.stop import Stopped
from tests.scenario.stepped_cell import SteppedCell

pytestmark = pytest.mark.stall(0.3)

QUICK: dict[str, Any] = {
    "live": True,
    "cycles": 2,
    "speed": [0.1, 0.1, 0.05, 0.1, 0.1, 0.1],
    "approach": 0.1,
    "settle": 0.04,
    "turn": [100.0, 150.0, 60.0, 20.0, 18.0, 10.0],
    "proof": [50.0, 75.0, 25.0, 10.0, 9.0, 5.0],
    "quiet": [40.0, 60.0, 20.0, 8.0, 8.0, 4.0],
    "pose": [0.0, 2.0, -8.0, 0.0, 32.0, 0.0],
}
"""Motions two to five times as fast as a laboratory's."""


@contextmanager
def here(_: object) -> Iterator[Executor]:
    """Give the worker that needs no process: the test is no clock that must not wait."""
    yield Here()


@pytest.mark.slow
def test_a_joint_is_measured_and_a_pause_holds_the_arm(tmp_path: Path) -> None:
    told = [""]

    def pauses() -> bool:
        return "clamp check" in told[-1]  # until the next step, or that it is paused, is told

    with SteppedCell(clamping=QUICK) as cell, raw_run(tmp_path, cell.config) as folder:
        recorded, way = measure(cell.config, (2,), folder, Desk(told.append, pauses=pauses))
        joints = cell.bench.controller.plant.joints
        assert not cell.bench.controller.plant.tripped
    assert [text.split("  ")[-1] for text in told if "paused" in text or "goes on" in text] == [
        "paused: the arm holds",
        "goes on",
    ]
    found = map_of(recorded[2], 2)
    raw, truth = extract(found, "piecewise linear"), joints[0, 2]
    assert raw.k_plus.high < 0.9 * truth
    assert raw.backlash.value == pytest.approx(joints[2, 2], abs=0.02e-3)
    assert way is not None
    axis = tracked_axis(way, 2)
    assert axis is not None
    motion = link_motion(recorded[2], axis, 2)
    assert motion is not None
    (slope,) = slope_over(motion[:, None], raw.spring_torque(found.angle) - raw.offset)
    # the tracker's noise leaves 15 % (one standard deviation) to two quick cycles
    assert slope == pytest.approx(1 / raw.k_plus.value - 1 / truth, rel=0.6)
    assert seen_tool(recorded[2]) is not None
    assert (tmp_path / "maps.html").exists()
    assert (tmp_path / "map-3.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("mishap", "reason"),
    [
        ("torque", "the torque of joint 3 is beyond its limit of 60 N m"),
        pytest.param("slip", "the clamp slips: joint 3 has moved by more than", marks=pytest.mark.slow),
        pytest.param("signals", "the torque signals have stopped: their line is down", marks=pytest.mark.slow),
    ],
)
def test_what_goes_wrong_is_named_and_the_robot_is_held(
    mishap: str, reason: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(session, "aside", here)
    clamping = QUICK | {"track": False, "speed": [0.1] * 6, "travel": [5e-3] * 6}
    if mishap == "torque":
        clamping |= {"torque": [200.0, 300.0, 60.0, 40.0, 36.0, 20.0], "turn": [100.0, 150.0, 59.0, 20.0, 18.0, 10.0]}
    with SteppedCell(clamping=clamping) as cell:

        def tell(text: str) -> None:
            if "2 cycles" in text and mishap == "slip":
                cell.mishaps.append(lambda: cell.bench.suffer("slip"))
            if "2 cycles" in text and mishap == "signals":
                cell.mishaps.append(cell.bench.signals.hang_up)

        with (
            raw_run(tmp_path, cell.config) as folder,
            pytest.raises(PartEnded, match=f"{reason}.*; the arm holds in step"),
        ):
            measure(cell.config, (2,), folder, Desk(tell))
    assert not (tmp_path / "joint-3.wav").exists()


def test_a_stop_holds_the_arm_and_says_where_it_stands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(session, "aside", here)
    told = [""]
    conduct = Conduct(lambda: "soft servo on" in told[-1])
    with (
        SteppedCell(clamping=QUICK | {"track": False}) as cell,
        raw_run(tmp_path, cell.config) as folder,
        pytest.raises(Stopped, match="stopped in step 2: the arm holds"),
    ):
        measure(cell.config, (2,), folder, Desk(told.append, conduct))
