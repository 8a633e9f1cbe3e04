"""The features of four directions, against the optimum."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.planning_pockets import draw
from stagectl.planning.exact import least_time
from stagectl.planning.features import FeaturesPlanner
from stagectl.planning.milling import mill, total
from stagectl.planning.pocket import check, plan
from tests.stagectl.planning.pockets import check_random_paths, figure_8_8, random_pocket


@pytest.mark.slow
def test_random_tables_are_milled_nearly_in_the_least_time() -> None:
    rng = np.random.default_rng(9)
    gaps = []
    for seed in range(8):
        pocket, best = draw(rng, 12, 12, 2, "EWNS")
        gaps.append(check(pocket, plan(pocket, "features", seed)).total / best - 1.0)
    assert np.mean(gaps) < 0.003
    assert max(gaps) < 0.016


@pytest.mark.slow
def test_figure_8_8_turns_when_every_segment_takes_longer_to_begin() -> None:
    fast, slow = figure_8_8(0.243), figure_8_8(4 * 0.243)
    assert check(fast, plan(fast, "features")).total == pytest.approx(69.40, abs=0.005)
    assert check(slow, plan(slow, "features")).total == pytest.approx(74.89, abs=0.005)


@pytest.mark.slow
def test_its_paths_are_legal_whatever_is_drawn_and_never_below_the_optimum() -> None:
    check_random_paths("features", np.random.default_rng(2), rows=8)


@pytest.mark.slow
def test_the_weight_of_the_time_still_to_be_spent_is_learned() -> None:
    pocket = random_pocket(np.random.default_rng(3), 12, 12, 2, "EWNS", True)
    for seed in range(3):
        share, whole = FeaturesPlanner(pocket, seed).weights
        assert whole == pytest.approx(-1.0, abs=0.15)
        assert -1.0 <= share <= 0.0


def test_a_side_that_turns_out_slow_is_left_within_three_segments() -> None:
    rng = np.random.default_rng(12)
    for _ in range(3):
        pocket, _ = draw(rng, 12, 12, 2, "EWNS")
        first = mill(pocket, FeaturesPlanner(pocket))[0].cut.side
        slow = replace(pocket, true={"theta": {first: 1.4}})
        segments = mill(slow, FeaturesPlanner(slow))
        assert segments[0].cut.side == first
        assert first not in {each.cut.side for each in segments[3:6]}
        assert total(segments) < 1.1 * least_time(slow)
