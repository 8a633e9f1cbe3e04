"""The cell runs in one graph: offline and in real time alike, bit for bit, and every fault ends in a named hold."""

import numpy as np
import pytest

from ctlblocks.clock import Paced
from stagectl.devices.signals import AXES
from stagectl.experiments.toroid.figures import figures
from tests.stagectl.experiments.toroid.short_cell import Milled, milled, short


@pytest.fixture(scope="module")
def cell() -> Milled:
    return milled("C")


def part(done: Milled, recording: str, name: str) -> np.ndarray:
    record = done.recordings[recording]
    return record.select([each for each in record.names if each == name or each.startswith(f"{name}_")]).data


def test_the_cell_runs_to_its_end_without_a_fault(cell: Milled) -> None:
    assert cell.reason == ""
    assert part(cell, "cell", "holding")[-1] == 0.0
    cut = part(cell, "surface", "cut")
    angle = np.degrees(np.arctan2(cut[-1, 2], cut[-1, 1]))
    assert angle == pytest.approx(90.0 + 360.0 * 0.005, abs=0.2)


@pytest.mark.slow
def test_in_real_time_the_numbers_are_the_same_bit_for_bit(cell: Milled) -> None:
    """Stage, robot, tracker and mid-ranging in one graph, on the timer."""
    live = milled("C", clock=Paced())
    for name, record in cell.recordings.items():
        assert record.data.tobytes() == live.recordings[name].data.tobytes(), name


def test_each_part_runs_at_its_own_rate(cell: Milled) -> None:
    assert {name: record.rate for name, record in cell.recordings.items()} == {
        "cell": 250.0,
        "surface": 2_000.0,
        "tracker": 2_000.0,
        "stage": 10_000.0,
    }


def test_a_robot_that_is_silent_for_three_cycles_is_held() -> None:
    done = milled("B", "plants.robot_options.mute=1.2")
    assert done.reason.startswith("the robot is silent for 0.016 s, must be <= 3 cycles")
    comes_to_rest(done)


def test_a_blind_tracker_holds_robot_and_stage() -> None:
    done = milled("C", "plants.tracker_options.blind=1.2", "plants.tracker_options.blind_for=0.1")
    assert done.reason.startswith("the tracker is blind for 0.0")
    assert "2 LEDs of frame" in done.reason
    comes_to_rest(done)


def test_a_tracker_that_is_blind_for_a_moment_is_waited_for() -> None:
    assert milled("B", "plants.tracker_options.blind=1.2", "plants.tracker_options.blind_for=0.03").reason == ""


def test_an_led_that_is_taken_for_another_holds_the_robot() -> None:
    done = milled("B", "plants.tracker_options.jump_at=1.2")
    assert "frame 7 jumps by" in done.reason
    comes_to_rest(done)


def test_a_stage_at_the_end_of_its_travel_for_too_long_holds_the_robot() -> None:
    done = milled("C", "plants.cut_options.force=5000.0", "feedback.saturated=0.05", "toroid.turn=0.02")
    assert "the stage is at an end of its travel on" in done.reason
    comes_to_rest(done)


def test_a_torque_supervision_that_trips_is_named() -> None:
    assert milled("A", "plants.robot_options.trip=1.2").reason == "the robot's motors are off"


def comes_to_rest(done: Milled) -> None:
    """Look that the references of robot and stage stand still from `limits.stop` after the hold on."""
    held = int(np.argmax(part(done, "cell", "holding")[300:] > 0.5)) + 300
    for name in ("reference", "fast_reference"):
        after = part(done, "cell", name)[held + round(0.1 * 250) :]
        assert len(after) > 100
        assert np.abs(after - after[-1]).max() < 3e-6
        np.testing.assert_array_equal(after[60:], np.broadcast_to(after[-1], after[60:].shape))


def test_the_axes_are_named(cell: Milled) -> None:
    assert [f"cut_{axis}" for axis in AXES] == list(cell.recordings["surface"].names[:3])


def test_the_toroids_arm_and_workpiece_win_over_those_of_other_experiments() -> None:
    made = short("A", "simulator.options.arm=irb140", "simulator.options.payload=1.0", "simulator.options.seed=5")
    options = made.plant_options()["robot"]
    assert (options["arm"], options["payload"], options["seed"]) == ("kuka", 20.0, 5)


def test_the_workpiece_is_kept_in_the_orientation_in_which_it_was_touched_off() -> None:
    turned = []
    for seconds in (0.0, 0.5):
        settings = "toroid.turn=0.05", f"feedback.orientation={seconds}", "simulator.options.seed=3"
        done = milled("B", *settings)
        assert done.reason == ""
        turned.append(figures(short("B", *settings), done.recordings, done.reason)["turned"])
    assert turned[1] < 0.8 * turned[0]
    assert turned[0] > 1e-4
