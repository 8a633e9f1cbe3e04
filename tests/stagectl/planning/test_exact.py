"""The optimum, against every path there is."""

import numpy as np
import pytest

from stagectl.planning import strips
from stagectl.planning.exact import MOST_STATES, ExactPlanner, Optimum, least_time
from stagectl.planning.milling import mill, total
from stagectl.planning.pocket import check, plan
from stagectl.planning.problem import Pocket
from stagectl.planning.strips import Cut, Rectangle, Standing, costs, untouched
from tests.stagectl.planning.pockets import EXAMPLE, figure_8_8, least_by_brute_force, random_pocket


@pytest.mark.sample(3)
@pytest.mark.parametrize("closed", [True, False])
@pytest.mark.parametrize(("tool", "feeds", "largest"), [(2, "EW", 6), (3, "EW", 6), (2, "EWNS", 4), (3, "EWNS", 4)])
def test_the_optimum_is_that_of_every_path_gone_through(tool: int, feeds: str, largest: int, closed: bool) -> None:
    rng = np.random.default_rng([tool, len(feeds), closed])
    for _ in range(30):
        rows, cols = (int(each) for each in rng.integers(tool, largest + 1, 2))
        pocket = random_pocket(rng, rows, cols, tool, feeds, closed)
        least = least_time(pocket)
        assert least == pytest.approx(least_by_brute_force(pocket), rel=1e-12)
        verdict = check(pocket, plan(pocket, "exact"))
        assert verdict.error is None
        assert verdict.complete
        assert verdict.total == pytest.approx(least, rel=1e-12)


def test_the_worked_example_takes_23_80_seconds() -> None:
    pocket = Pocket.from_dict(EXAMPLE)
    path = plan(pocket, "exact")
    assert check(pocket, path).total == pytest.approx(23.796, abs=1e-9)
    names = [str(each[0]) for each in path]
    assert sorted(names) == sorted("E3 W3 E3 W3 E2u W3 E2u W3 E2u W3 E3".split())


def test_figure_8_8_turns_when_every_segment_takes_longer_to_begin() -> None:
    """Sörnmo 2015, fig. 8.8: 69.4 s along x; acceleration 4 times slower, 74.9 s along y and 76.7 s on the old path."""
    fast, slow = figure_8_8(0.243), figure_8_8(4 * 0.243)
    path = plan(fast, "exact")
    assert {each[0] for each in path} == {"E2", "W2"}
    assert check(fast, path).total == pytest.approx(69.40, abs=0.005)
    assert check(slow, path).total == pytest.approx(76.69, abs=0.005)
    path = plan(slow, "exact")
    assert {each[0] for each in path} == {"N2", "S2"}
    assert check(slow, path).total == pytest.approx(74.89, abs=0.005)


def test_from_any_state_on_the_way_the_rest_of_the_time_is_what_was_promised() -> None:
    pocket = random_pocket(np.random.default_rng(3), 9, 7, 2, "EWNS", False)
    optimum, cost = Optimum(costs(pocket)), costs(pocket)
    standing = Standing(Rectangle(2, 9, 1, 6), 6)
    _, promised = optimum.best(standing)
    spent = 0.0
    while not standing.is_done:
        cut, left = optimum.best(standing)
        assert spent + left == pytest.approx(promised, rel=1e-12)
        spent += strips.moving(cut, standing, cost) + strips.cutting(cut, standing, cost)
        standing = strips.after(cut, standing)
    assert spent == pytest.approx(promised, rel=1e-12)


def test_a_strip_that_turns_out_slow_is_not_milled_again() -> None:
    """The first type costs ten times what is believed: the planner notes it, and does better than who does not."""
    rate = {"E2": 1.0, "W2": 1.0, "E1u": 0.9, "E1d": 0.9, "W1u": 0.9, "W1d": 0.9}
    believed = Pocket(12, 12, 2, "EW", rate)
    first = str(plan(believed, "exact")[0][0])
    pocket = Pocket(12, 12, 2, "EW", rate, true={first: 10.0})
    names = [str(each[0]) for each in plan(pocket, "exact")]
    assert names.count(first) == 1
    stubborn = check(pocket, plan(believed, "exact"))
    assert total(mill(pocket, ExactPlanner(pocket))) < 0.5 * stubborn.total


def test_a_pocket_of_too_many_states_is_refused() -> None:
    rate = dict.fromkeys(figure_8_8(0.0).rate, 1.0)
    with pytest.raises(ValueError, match=f"must be <= {MOST_STATES}"):
        least_time(Pocket(100, 100, 2, "EWNS", rate))


def test_the_first_strip_along_a_wall_is_a_slot() -> None:
    cost = costs(Pocket.from_dict(EXAMPLE))
    assert {cut.k for cut in strips.legal(untouched(Pocket.from_dict(EXAMPLE)), cost)} == {3}
    inside = Standing(Rectangle(3, 27, 0, 30), 0)
    assert len(list(strips.legal(inside, cost))) == 12


def test_in_general_position_sixteen_strips_are_legal_in_four_directions() -> None:
    pocket = figure_8_8(0.0)
    assert len(list(strips.legal(Standing(Rectangle(4, 10, 3, 8), 0), costs(pocket)))) == 16


def test_down_milling_has_the_material_to_the_right_of_the_feed() -> None:
    names = {(cut.side, cut.name(2)) for way in range(8) for cut in [Cut(way, 1)]}
    assert names == {("N", "E1d"), ("N", "W1u"), ("S", "E1u"), ("S", "W1d"),
                     ("W", "N1d"), ("W", "S1u"), ("E", "N1u"), ("E", "S1d")}  # fmt: skip
