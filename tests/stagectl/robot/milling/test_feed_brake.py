"""Force control where the force rises at once, and where a force sensor's scale is wrong."""

import numpy as np
import pytest

from stagectl.robot.feed_config import ForceFeed
from stagectl.robot.milling.feed_record import BRAKED, SCALE
from tests.stagectl.robot.milling.feed_bench import Bench, H


@pytest.mark.parametrize(("kappa", "share"), [(4e-4, 1.03), (2e-3, 0.97)])
def test_wood_that_is_three_times_as_hard_at_once_is_braked_for(kappa: float, share: float) -> None:
    largest = []
    for brake in (ForceFeed().brake, 100.0):
        bench = Bench(brake=brake)
        bench.kappa = kappa
        bench.run(2.0)
        assert not bench.block.notice & BRAKED
        bench.kappa = kappa / 3.0
        largest.append(bench.run(1.0)[:, 2].max())
        assert bool(bench.block.notice & BRAKED) == (brake < 100.0)
        assert bench.run(1.0)[-100:, 2].mean() == pytest.approx(10.0, rel=0.01)
    assert largest[0] < share * largest[1]


def test_a_spark_brakes_for_a_sample_or_two_and_leaves_no_error() -> None:
    bench = Bench()
    bench.run(2.0)
    bench.run(0.004, force=30.0)
    assert bench.run(0.5)[:, 2].min() > 5.0
    assert bench.of("resultant") == pytest.approx(10.0, abs=0.2)


def braked(bench: Bench, seconds: float) -> int:
    """Show three times the force for 12 ms, ten times a second; return how often it brakes."""
    found, was = 0, False
    for n in range(round(seconds / H)):
        bench.run(H, force=float(np.hypot(*bench.force)) * (3.0 if n % 25 < 3 else 1.0))
        is_on = bool(bench.block._feed.brake.is_on)  # noqa: SLF001 (what is recorded is the feed)
        found, was = found + (is_on and not was), is_on
    return found


def test_a_swing_is_braked_for_once_and_not_where_it_comes_again() -> None:
    bench = Bench()
    bench.run(2.0)
    assert 1 <= braked(bench, 2.0) <= 2


def test_a_robot_that_does_not_follow_as_identified_is_not_braked() -> None:
    bench = Bench()
    bench.run(1.0)
    bench.pull = 0.5
    bench.run(2.0)
    assert bench.block._feed.is_careful  # noqa: SLF001
    assert braked(bench, 0.3) == 0


def shown(bench: Bench, seconds: float, scale: float) -> None:
    """Go on with a sensor that shows another force than there is."""
    for _ in range(round(seconds / H)):
        bench.run(H, force=scale * float(np.hypot(*bench.force)))


@pytest.mark.parametrize("scale", [0.5, 1.0, 2.0])
def test_a_sensors_scale_is_noticed_where_kappa_is_known_and_only_then(scale: float) -> None:
    for familiar in (1.5, ForceFeed().familiar):
        bench = Bench(familiar=familiar)
        shown(bench, 3.0, scale)
        assert bench.phase == "controlling"
        assert bool(bench.block.notice & SCALE) == (familiar < 2.0 and scale != 1.0)


def test_it_retreats_where_a_known_kappa_makes_the_force_an_overload() -> None:
    bench = Bench(familiar=1.5, overload=30.0)
    shown(bench, 3.0, 0.1)
    assert bench.phase == "retreated"
    assert "by what is known of the material" in bench.block.reason
