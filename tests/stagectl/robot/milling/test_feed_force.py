"""The block of force control: its phases, its limits, and what it does when something goes wrong."""

import numpy as np
import pytest

from stagectl.robot.feed_config import ForceFeed
from stagectl.robot.milling import force_law_kernel as law
from stagectl.robot.milling.feed_force import FeedForce
from stagectl.robot.milling.feed_notices import NOTICES, words
from stagectl.robot.milling.feed_record import CHATTER
from stagectl.robot.milling.feed_record import MODEL as NOT_AS_IDENTIFIED
from tests.stagectl.robot.milling.feed_bench import MODEL, Bench, H


def test_it_is_idle_until_it_is_to_run_and_again_afterwards() -> None:
    bench = Bench()
    assert (bench.run(0.1, running=0.0)[:, :2] == 0.0).all()
    bench.run(0.5)
    assert bench.phase == "controlling"
    assert bench.run(0.1, running=0.0)[-1, 1] == 0.0
    assert bench.phase == "idle"


def test_it_approaches_touches_estimates_and_controls_in_this_order() -> None:
    told = Bench(ahead=1e-3).run(1.5)
    assert np.unique(told[:, 0]).tolist() == [1.0, 2.0, 3.0]
    assert (np.diff(told[:, 0]) >= 0).all()
    assert told[-1, 2] == pytest.approx(10.0, abs=0.02)


def test_the_first_feed_of_control_is_that_of_before() -> None:
    told = Bench(start="constant").run(1.0)
    at = int(np.argmax(told[:, 0] == 3.0))
    assert abs(told[at, 1] - told[at - 1, 1]) < 4e-3


def test_a_gentle_start_keeps_the_force_near_what_is_wanted_where_the_thesis_start_does_not() -> None:
    assert Bench(start="gentle").run(1.0)[:, 2].max() < 13.0
    assert Bench(start="constant").run(1.0)[:, 2].max() > 18.0


def test_the_estimates_come_to_what_is_true_and_their_deviations_shrink() -> None:
    bench = Bench(kappa=2e-3, beta=0.0)
    bench.run(1.0)
    assert bench.of("kappa") == pytest.approx(4e-4, rel=0.02)
    assert bench.of("beta") == pytest.approx(0.5, rel=0.01)
    assert bench.of("kappa_deviation") < 5e-5


def test_a_new_segment_is_estimated_anew() -> None:
    bench = Bench()
    bench.run(1.0)
    bench.run(0.1, running=0.0)
    bench.run(0.004)
    assert bench.of("kappa_deviation") == pytest.approx(ForceFeed().kappa_deviation)


def test_nothing_is_learned_without_contact() -> None:
    bench = Bench(ahead=1.0)
    bench.run(1.0)
    assert bench.phase == "approaching"
    assert bench.of("kappa") == ForceFeed().kappa


def test_contact_that_is_lost_ends_control_until_it_is_back() -> None:
    bench = Bench()
    bench.run(1.0)
    bench.gap += 2e-3
    told = bench.run(1.5)
    assert 1.0 in told[:, 0]
    assert told[:, 1].max() <= ForceFeed().highest
    assert bench.phase == "controlling"
    assert told[-1, 2] == pytest.approx(10.0, abs=0.05)


def test_the_feed_keeps_its_limits_and_does_not_wind_up() -> None:
    bench = Bench(highest=2e-3, initial=2e-3)
    told = bench.run(2.0)
    assert told[:, 1].max() <= 2e-3
    assert told[-1, 2] < 9.0
    bench.kappa = 1e-4  # now the force is reached
    after = bench.run(1.5)[:, 2]
    assert after.max() < 13.0
    assert after[-1] == pytest.approx(10.0, abs=0.1)


@pytest.mark.parametrize("stiffness", [50e3, 112.5e3])
def test_a_stiffness_that_is_wrong_by_a_third_leaves_no_error(stiffness: float) -> None:
    bench = Bench()
    bench.stiffness = stiffness
    told = bench.run(2.0)
    np.testing.assert_allclose(told[-100:, 2], 10.0, atol=0.05)


def test_overload_makes_it_retreat_and_stay_with_its_reason() -> None:
    bench = Bench()
    bench.run(1.0)
    place = bench.place
    bench.run(0.008, force=90.0)
    assert bench.phase == "retreating"
    bench.run(1.0)
    assert bench.phase == "retreated"
    assert bench.block.reason == "the force is beyond force.overload, 80 N"
    assert bench.of("reference") == pytest.approx(0.0, abs=1e-4)
    assert place - bench.place == pytest.approx(ForceFeed().distance, rel=0.25)


def test_a_spark_of_the_sensor_is_no_overload() -> None:
    bench = Bench()
    bench.run(1.0)
    bench.run(0.004, force=500.0)
    bench.run(0.5)
    assert bench.phase == "controlling"


@pytest.mark.parametrize(("valid", "force"), [(0.0, None), (1.0, float("nan"))])
def test_no_valid_force_for_too_long_makes_it_retreat(valid: float, force: float | None) -> None:
    bench = Bench()
    bench.run(1.0)
    bench.run(0.016, valid=valid, force=force)
    assert bench.phase == "controlling"
    bench.run(0.008, valid=valid, force=force)
    assert bench.phase == "retreating"
    assert bench.block.reason == "there is no valid force for 0.02 s"
    assert np.isfinite(bench.run(1.0, valid=valid, force=force)).all()


def test_a_velocity_that_is_no_number_is_waited_for() -> None:
    bench = Bench()
    bench.run(1.0)
    bench.velocity = float("nan")
    bench.run(0.004)
    assert np.isfinite(bench.of("reference"))
    bench.run(0.5)
    assert bench.of("resultant") == pytest.approx(10.0, abs=0.1)


def test_a_model_of_another_rate_is_refused() -> None:
    with pytest.raises(ValueError, match="250 samples/s, must be of 500"):
        FeedForce(ForceFeed(), MODEL).prepare(500.0, 1)


def ripples(bench: Bench, seconds: float, share: float, hertz: float) -> np.ndarray:
    """Go on with a ripple on what the sensor shows; return the size of the force that is shown, N."""
    told = []
    for n in range(round(seconds / H)):
        plain = bench.force.copy()
        bench.force = plain * (1.0 + share * np.sin(2 * np.pi * hertz * n * H))
        told.append(np.hypot(*bench.force))
        seen, bench.force = bench.force, plain
        bench.run(H, force=float(np.hypot(*seen)))
    return np.array(told)


@pytest.mark.parametrize("hertz", [7.0, 23.0, 83.0, 101.0])
def test_a_ripple_moves_the_mean_force_by_less_than_a_hundredth(hertz: float) -> None:
    bench = Bench()
    bench.run(1.0)
    assert ripples(bench, 8.0, 0.3, hertz)[500:].mean() == pytest.approx(10.0, rel=0.01)


def test_gains_that_are_renewed_move_no_output() -> None:
    bench = Bench()
    bench.run(1.0)
    feed: np.record = bench.block._feeds.copy().view(np.recarray)[0]  # noqa: SLF001 (what the law is about)
    before = law.wanted(feed.law, 0.004, 9.0)
    feed.cutting.kappa *= 3.0
    law.adapt(feed, 0.004, 9.0)
    assert feed.law.changes == bench.block._feed.law.changes + 1  # noqa: SLF001
    assert law.wanted(feed.law, 0.004, 9.0) == pytest.approx(before, rel=1e-9)


def test_a_force_almost_across_the_feed_is_controlled() -> None:
    bench = Bench()
    bench.beta = 4.0
    told = bench.run(2.0)
    assert bench.phase == "controlling"
    assert told[-100:, 2].mean() == pytest.approx(10.0, rel=0.01)


def test_a_sensor_whose_signs_are_turned_makes_no_difference() -> None:
    bench = Bench()
    for _ in range(500):
        bench.run(H, force=-float(np.hypot(*bench.force)))
    assert np.hypot(*bench.force) == pytest.approx(10.0, rel=0.02)


def test_a_sensor_that_shows_the_same_again_and_again_makes_it_retreat() -> None:
    bench = Bench()
    bench.run(1.0)
    bench.noise = 0.0
    bench.run(0.3, force=9.0)
    assert bench.phase in ("retreating", "retreated")
    assert bench.block.reason == "the force has been exactly the same for 0.2 s"


def test_a_robot_that_does_not_follow_as_identified_is_noticed_and_the_force_is_held_all_the_same() -> None:
    bench = Bench()
    bench.run(1.0)
    assert bench.block.notice & NOT_AS_IDENTIFIED == 0
    bench.pull = 0.5  # it goes half as fast as it is asked to
    told = bench.run(3.0)
    assert bench.block.notice & NOT_AS_IDENTIFIED
    assert words(bench.block.notice & NOT_AS_IDENTIFIED) == [NOTICES[NOT_AS_IDENTIFIED]]
    assert told[-250:, 2].mean() == pytest.approx(10.0, rel=0.01)


def test_a_peak_that_grows_is_chatter_and_lowers_the_feed() -> None:
    bench = Bench()
    bench.run(1.5)
    feed = bench.of("wanted")
    ripples(bench, 1.0, 0.6, 71.0)
    assert bench.block.notice & CHATTER
    assert bench.of("wanted") < 0.85 * feed


def test_chatter_that_no_lower_feed_ends_makes_it_retreat() -> None:
    bench = Bench(chattering=1.0)
    bench.run(1.5)
    ripples(bench, 2.5, 0.6, 71.0)
    assert bench.phase == "controlling"
    ripples(bench, 1.5, 0.6, 71.0)
    assert bench.phase in ("retreating", "retreated")
    assert bench.block.reason == (
        "the tool still chatters 1 s after the feed was lowered for the last time: mill less deep, or at another speed "
        "of the spindle"
    )


def test_chatter_that_a_lower_feed_ends_is_milled_on_through() -> None:
    bench = Bench(chattering=0.1)
    bench.run(1.5)
    feed = bench.of("wanted")
    for _ in range(40):
        ripples(bench, 0.1, 0.6 if bench.of("wanted") > 0.6 * feed else 0.05, 71.0)
    assert bench.phase == "controlling"
    assert 0.4 * feed < bench.of("wanted") < 0.6 * feed


def test_a_ripple_that_was_there_from_the_beginning_is_no_chatter() -> None:
    bench = Bench(chattering=0.1)
    ripples(bench, 4.0, 0.6, 71.0)
    assert bench.phase == "controlling"
    assert not bench.block.notice & CHATTER
