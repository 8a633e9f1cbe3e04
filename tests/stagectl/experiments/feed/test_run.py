"""Force-controlled milling in one graph: it holds the force, and every fault ends in a retreat and a named reason."""

import numpy as np
import pytest

from rigkit.experiment.runner import STOPPED, Conduct
from stagectl.experiments.feed.measures import figures, retold, safe_feeds, strips
from stagectl.experiments.feed.pocketed import Pocketed
from stagectl.experiments.feed.process_run import channel
from stagectl.experiments.feed.recorded import made
from stagectl.experiments.feed.surroundings import recorded
from stagectl.robot.milling.feed_force import PHASES
from tests.stagectl.experiments.feed.small_pocket import LENGTH, milled, small


@pytest.fixture(scope="module")
def pocket() -> Pocketed:
    """Return two slots, the second one stepped over to."""
    return milled(small(rows=6))


def at(done: Pocketed, name: str) -> np.ndarray:
    return channel(done.recording, name)


def test_the_pocket_is_milled_segment_by_segment(pocket: Pocketed) -> None:
    assert pocket.reason == ""
    assert sum(each.cut.k for each in pocket.segments) == 6
    assert at(pocket, "is_finished").sum() == len(pocket.segments)
    assert at(pocket, "number")[-1] == 0.0


def test_the_force_is_held_while_it_is_controlled(pocket: Pocketed) -> None:
    on = at(pocket, "phase") == PHASES.index("controlling")
    late = on & np.roll(on, 100)  # 0.4 s: what it may take to settle
    force = np.hypot(at(pocket, "true_force_x"), at(pocket, "true_force_y"))[late]
    assert force.mean() == pytest.approx(10.0, abs=0.4)
    assert np.abs(force - 10.0).max() < 2.0


def test_kappa_and_beta_are_known_while_it_is_controlled(pocket: Pocketed) -> None:
    late = (at(pocket, "phase") == PHASES.index("controlling")) & (np.roll(at(pocket, "phase"), 60) == 3.0)
    kappa = at(pocket, "kappa")[late] / at(pocket, "true_kappa")[late]
    assert np.abs(np.median(kappa) - 1.0) < 0.05
    assert np.abs(at(pocket, "beta") - at(pocket, "true_beta"))[late].mean() < 0.06


def test_a_finished_segment_says_how_long_it_took_and_how_much_the_force_varied(pocket: Pocketed) -> None:
    running = at(pocket, "is_running")
    begun, ended = np.flatnonzero(np.diff(running) > 0), np.flatnonzero(at(pocket, "is_finished"))
    for segment, first, last in zip(pocket.segments, begun, ended, strict=True):
        assert segment.duration == pytest.approx((last - first) / 250.0, abs=0.005)
        assert 0.05 < segment.force_deviation < 2.0


def test_what_the_sensors_said_makes_the_same_run_again_bit_for_bit(pocket: Pocketed) -> None:
    again = milled(small(rows=6), recorded(pocket.recording)).recording
    assert len(again.names) > 30
    for name in (each for signal in made("force") for each in signal.channels):
        assert channel(again, name).tobytes() == at(pocket, name).tobytes(), name


def test_a_recorded_pocket_is_retold(pocket: Pocketed) -> None:
    plan = small(rows=6)
    assert retold(pocket.recording, plan.pocket) == pocket.segments
    assert retold(pocket.recording, plan.pocket, [each.in_path for each in pocket.segments]) == pocket.segments


def test_the_figures_are_those_of_the_segments(pocket: Pocketed) -> None:
    cell = small().cell
    found = figures(pocket, cell)
    assert found["segments"] == len(pocket.segments)
    assert found["milling"] == pytest.approx(sum(each.duration for each in pocket.segments))
    assert found["seconds"] > found["milling"]
    assert found["force_mean"] == pytest.approx(10.0, abs=0.4)
    for each in strips(pocket, cell):
        assert each.length == pytest.approx(LENGTH, abs=1e-5)
        assert 0.5 * each.length / each.duration < each.slowest < 3.0 * each.length / each.duration


def test_the_safe_feed_of_a_type_is_its_lowest_and_of_others_the_lowest_of_all(pocket: Pocketed) -> None:
    found = strips(pocket, small().cell)
    feeds = safe_feeds(found, small().pocket.types)
    assert feeds[found[0].name] == min(each.slowest for each in found if each.name == found[0].name)
    assert feeds["E1d"] == min(each.slowest for each in found)
    with pytest.raises(ValueError, match="no segment was under force control for long enough"):
        safe_feeds([], small().pocket.types)


def test_position_control_goes_at_the_feed_that_is_given() -> None:
    done = milled(small(feeds=dict.fromkeys(small().pocket.types, 0.012)))
    assert done.reason == ""
    assert np.median(at(done, "feed")[at(done, "is_running") > 0.5]) == 0.012


def test_position_control_is_held_by_overload() -> None:
    done = milled(small(["force.overload=5.0"], feeds=dict.fromkeys(small().pocket.types, 0.03)))
    assert done.reason == "the force is beyond force.overload, 5 N; segment 1"
    assert at(done, "holding")[-1] == 1.0


def retreats(done: Pocketed) -> None:
    """Look that the tool went back along its segment, and then stood still."""
    phases = at(done, "phase")
    assert (phases == PHASES.index("retreating")).any()
    place = at(done, "place_x")
    turned = int(np.argmax(phases == PHASES.index("retreating")))
    assert place[turned] - place[-1] > 1e-3
    assert at(done, "holding")[-1] == 1.0
    assert np.ptp(at(done, "reference_1")[-50:]) < 1e-9


@pytest.mark.parametrize(
    ("option", "text"),
    [("silent=1.9", "is silent: for"), ("stuck=1.9", "is saturated: for")],
    ids=["silent", "saturated"],
)
def test_a_force_sensor_that_fails_makes_the_tool_retreat_and_is_named(option: str, text: str) -> None:
    done = milled(small([f"plants.force_sensor_options.{option}"]))
    assert text in done.reason
    assert done.reason.endswith("segment 1")
    retreats(done)


def test_a_force_sensor_that_drifts_is_named_at_the_next_rest() -> None:
    done = milled(small(["plants.force_sensor_options.drift=20.0", "force_sensor.drift=0.5"]))
    assert "drifted" in done.reason
    assert len(done.segments) == 1


def test_a_force_sensor_that_is_silent_between_segments_holds_the_robot() -> None:
    done = milled(small(["plants.force_sensor_options.silent=0.9"]))
    assert "is silent: for" in done.reason
    assert not (at(done, "is_running") > 0.5).any()


def test_overload_makes_the_tool_retreat() -> None:
    done = milled(small(["force.overload=8.0"]))
    assert done.reason == "the force is beyond force.overload, 8 N; segment 1"
    retreats(done)


def test_a_robot_that_is_silent_is_held() -> None:
    done = milled(small(["plants.robot_options.mute=2.0", "plants.robot_options.mute_for=0.1"]))
    assert done.reason.startswith("the robot is silent for")


def test_a_segment_that_takes_too_long_is_a_fault() -> None:
    done = milled(small(["segments.patience=0.3"]))
    assert done.reason.startswith("segment 1 is not milled after 0.3")


def test_who_stops_it_is_named() -> None:
    assert milled(small(), conduct=Conduct(stopped=lambda: True)).reason == STOPPED


def test_a_stop_within_a_strip_goes_back_along_it_before_the_robot_is_held() -> None:
    looks: list[int] = []

    def stopped() -> bool:
        looks.append(1)
        return len(looks) > 60  # 20 ms each: the force is controlled by then

    done = milled(small(), conduct=Conduct(stopped=stopped))
    assert done.reason == STOPPED
    assert at(done, "phase")[-1] == PHASES.index("retreated")
    begun = int(np.argmax(at(done, "is_running") > 0.5))
    along = np.abs(at(done, "place_x") - at(done, "place_x")[begun])[begun:]
    assert along.max() - along[-1] == pytest.approx(2e-3, rel=0.3)
    assert np.hypot(at(done, "true_force_x"), at(done, "true_force_y"))[-1] < 1e-3  # N
