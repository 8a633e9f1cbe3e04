"""Chapter 7's rule: what it finds, what it tries out, and what it is told to avoid."""

from dataclasses import replace

import numpy as np
import pytest

from stagectl.planning.exact import least_time
from stagectl.planning.milling import Milled, mill, total
from stagectl.planning.pocket import check
from stagectl.planning.problem import Pocket
from stagectl.planning.sequential import Rule, SequentialPlanner, trained
from tests.stagectl.planning.pockets import EXAMPLE, figure_8_8, random_pocket

POCKET = Pocket.from_dict(EXAMPLE)


def _pockets(planner: SequentialPlanner, pocket: Pocket, count: int) -> list[list[Milled]]:
    return [mill(pocket, planner) for _ in range(count)]


def test_on_the_worked_example_the_rule_takes_23_94_seconds() -> None:
    segments = mill(POCKET, SequentialPlanner(POCKET, trained(POCKET)))
    verdict = check(POCKET, [each.in_path for each in segments])
    assert verdict.complete
    assert verdict.total == pytest.approx(23.94, abs=1e-9)


def test_its_paths_are_legal_in_any_pocket_and_use_two_directions() -> None:
    rng = np.random.default_rng(5)
    pockets = [random_pocket(rng, 13, 11, tool, feeds, closed)
               for tool in (2, 3) for feeds in ("EW", "EWNS") for closed in (True, False)]  # fmt: skip
    for pocket in pockets:
        path = [each.in_path for each in mill(pocket, SequentialPlanner(pocket, trained(pocket)))]
        assert check(pocket, path).complete
        assert {each[3] for each in path} <= {"E", "W"}


def test_without_training_every_type_is_tried_and_the_third_pocket_takes_the_trained_time() -> None:
    """Sörnmo 2015, table 7.1: simulations 3 and 4 end where simulation 1 is."""
    sooner = {}
    for eta in (2.0, 1.25):
        planner = SequentialPlanner(POCKET, {}, Rule(eta=eta))
        done = _pockets(planner, POCKET, 3)
        assert all(each.rates for each in planner.sets.values())
        assert total(done[2]) == pytest.approx(23.94, abs=1e-9)
        sooner[eta] = sum(map(total, done))
    assert sooner[1.25] < sooner[2.0]
    assert total(done[0]) > 1.05 * 23.94


def test_what_is_five_times_slower_one_way_is_milled_the_other_way_with_lifts() -> None:
    """Sörnmo 2015, simulation 5."""
    slow = replace(POCKET, rate={name: rate * (5.0 if name[0] == "E" else 1.0) for name, rate in POCKET.rate.items()})
    last = _pockets(SequentialPlanner(slow, {}), slow, 2)[1]
    assert {each.name[0] for each in last} == {"W"}
    assert all(each.is_lifted for each in last[1:])
    assert total(last) == pytest.approx(least_time(slow))


def test_forces_that_vary_are_avoided_where_w1_says_so() -> None:
    forces = {name: [8.0 if name[1] == "3" else 0.5] * 2 for name in POCKET.types}
    calm = SequentialPlanner(POCKET, trained(POCKET), Rule(force_weight=0.02), forces)
    assert all(each.cut.k < 3 for each in mill(POCKET, calm)[1:])  # the wall asks for one slot


def test_types_that_vary_are_tried_where_w2_says_so_and_then_left_alone() -> None:
    known = trained(POCKET)
    known["W2d"] = [POCKET.rate["W2d"], 1.6 * POCKET.rate["W2d"]]
    assert "W2d" not in {each.name for each in mill(POCKET, SequentialPlanner(POCKET, known))}
    planner = SequentialPlanner(POCKET, known, Rule(deviation_weight=-5.0))
    spread = planner.sets["W2d"].deviation()
    done = _pockets(planner, POCKET, 3)
    assert "W2d" in {each.name for each in done[0]}
    assert planner.sets["W2d"].deviation() < 0.1 * spread
    assert total(done[2]) == pytest.approx(23.94, abs=0.6)


def test_a_slow_side_is_known_and_left_to_the_last() -> None:
    pocket = replace(POCKET, theta={"S": 3.0}, v_lift=None)
    assert {each.cut.side for each in mill(pocket, SequentialPlanner(pocket, trained(pocket)))} == {"N"}


def test_a_pocket_of_four_directions_keeps_what_is_learned_by_type() -> None:
    pocket = figure_8_8(0.243)
    planner = SequentialPlanner(pocket, {})
    mill(pocket, planner)
    assert planner.sets["E2"].mean() == pytest.approx(0.6697)
    assert set(planner.sets) == {"E2", "E1u", "E1d", "W2", "W1u", "W1d"}


def test_an_eta_that_trains_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match=r"eta is 0.5, must be >= 1"):
        Rule(eta=0.5)
