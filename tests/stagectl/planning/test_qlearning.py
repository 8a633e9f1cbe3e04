"""Q-learning of two directions, against the optimum."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.planning_pockets import draw
from stagectl.planning.exact import least_time
from stagectl.planning.milling import mill, total
from stagectl.planning.pocket import check, plan
from stagectl.planning.problem import Pocket
from stagectl.planning.qlearning import QLearningPlanner
from stagectl.planning.strips import untouched
from tests.stagectl.planning.pockets import EXAMPLE, check_random_paths, figure_8_8, random_pocket


@pytest.mark.slow
def test_nearly_every_random_table_is_milled_in_the_least_time() -> None:
    rng = np.random.default_rng(8)
    gaps = []
    for _ in range(20):
        pocket, best = draw(rng, 13, 13, 2, "EW")
        path = plan(pocket, "qlearning")
        gaps.append(check(pocket, path).total / best - 1.0)
    assert np.mean(np.array(gaps) < 1e-9) >= 0.95
    assert max(gaps) < 0.02


def test_the_worked_example_takes_23_80_seconds() -> None:
    pocket = Pocket.from_dict(EXAMPLE)
    assert total(mill(pocket, QLearningPlanner(pocket))) == pytest.approx(23.796)


def test_its_paths_are_legal_whatever_is_drawn_and_never_below_the_optimum() -> None:
    check_random_paths("qlearning", np.random.default_rng(4), rows=10)


def test_where_lifts_are_slow_it_finds_the_optimum() -> None:
    rng = np.random.default_rng(6)
    for _ in range(5):
        pocket = replace(random_pocket(rng, 9, 9, 2, "EW", False), t_lift=100.0, theta={})
        assert total(mill(pocket, QLearningPlanner(pocket))) == pytest.approx(least_time(pocket), rel=1e-9)


def test_a_side_that_turns_out_slow_is_left_within_three_segments() -> None:
    pocket = replace(figure_8_8(0.2), feeds="EW", rate={
        "E2": 1.0, "W2": 1.02, "E1u": 0.7, "E1d": 0.71, "W1u": 0.72, "W1d": 0.73}, true={"theta": {"N": 2.0}},
        theta={"S": 1.01}, t_lift=1.0)  # fmt: skip
    sides = [each.cut.side for each in mill(pocket, QLearningPlanner(pocket))]
    assert sides[0] == "N"
    assert sides[3:] == ["S"] * len(sides[3:])


def test_training_goes_on_from_the_last_q() -> None:
    """What is known already needs no more than one look."""
    pocket = Pocket.from_dict(EXAMPLE)
    planner = QLearningPlanner(pocket)
    planner.choose(untouched(pocket))
    first = planner.transitions
    planner.choose(untouched(pocket))
    assert planner.transitions < first
