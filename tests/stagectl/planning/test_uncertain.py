"""Rates that are not sure: what one segment says of the others, and what a planner makes of it."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.planning_chapter_7 import published
from benchmarks.planning_pockets import draw
from stagectl.planning.exact import least_time
from stagectl.planning.milling import mill, total
from stagectl.planning.pocket import PocketFault, check, planner, untrained
from stagectl.planning.problem import Pocket
from stagectl.planning.rate_belief import MEASURED, Prior, measured, unknown
from stagectl.planning.strips import costs
from tests.stagectl.planning.pockets import EXAMPLE, figure_8_8, random_pocket

POCKET = Pocket.from_dict(EXAMPLE)


def test_a_strip_that_was_slow_off_a_side_says_so_of_the_others_off_it() -> None:
    belief = measured(figure_8_8(0.0))
    before = belief.mean.reshape(8, 2).copy()
    belief.observe(0, 1.4 * np.exp(before[0, 0]))
    rise = np.exp(belief.mean.reshape(8, 2) - before)
    assert rise[0, 0] == pytest.approx(1.4, abs=0.01)
    assert np.all(rise[:2] > 1.3)
    assert np.all(rise[4:] < 1.05)
    assert belief.deviation[0] == pytest.approx(MEASURED.noise, rel=0.05)


def test_what_was_seen_often_is_believed() -> None:
    belief = unknown(POCKET)
    for _ in range(50):
        belief.observe(3, 0.2)
    assert np.exp(belief.mean[3]) == pytest.approx(0.2, rel=1e-3)
    assert np.all(np.isfinite(belief.deviation))
    assert belief.deviation[3] < 0.01


def test_rates_that_are_known_are_planned_exactly() -> None:
    assert total(mill(POCKET, planner("uncertain", POCKET))) == pytest.approx(23.796)
    rng = np.random.default_rng(2)
    for feeds in ("EW", "EWNS"):
        pocket = random_pocket(rng, 8, 7, 2, feeds, True)
        segments = mill(pocket, planner("uncertain", pocket))
        assert check(pocket, [each.in_path for each in segments]).complete
        assert total(segments) == pytest.approx(least_time(pocket))


def test_three_pockets_of_which_nothing_is_known_take_less_than_by_the_rule() -> None:
    pocket = published()
    times = {}
    for name in ("sequential", "uncertain"):
        made = untrained(name, pocket)
        times[name] = sum(total(mill(pocket, made)) for _ in range(3))
    assert times["uncertain"] < 0.95 * times["sequential"]
    assert times["uncertain"] < 1.03 * 3 * least_time(pocket)


def test_a_side_that_turns_out_slow_costs_less_than_with_q_learning() -> None:
    rng = np.random.default_rng(12)
    gaps: dict[str, list[float]] = {"uncertain": [], "qlearning": []}
    for _ in range(3):
        pocket, _ = draw(rng, 10, 10, 2, "EWNS")
        for name, found in gaps.items():
            first = mill(pocket, planner(name, pocket))[0].cut.side
            slow = replace(pocket, true={"theta": {first: 1.4}})
            found.append(total(mill(slow, planner(name, slow))) / least_time(slow))
    assert np.mean(gaps["uncertain"]) < np.mean(gaps["qlearning"])


def test_the_pocket_s_rates_are_not_looked_at_where_nothing_is_known() -> None:
    other = replace(POCKET, rate=dict.fromkeys(POCKET.rate, 1.0))
    np.testing.assert_array_equal(unknown(POCKET).hoped_for(), unknown(other).hoped_for())
    np.testing.assert_allclose(measured(POCKET).hoped_for(), costs(POCKET).rate.ravel())


def test_a_planner_that_cannot_train_itself_is_refused() -> None:
    with pytest.raises(PocketFault, match="planner is 'exact', must be one of sequential, uncertain to train itself"):
        untrained("exact", POCKET)


@pytest.mark.parametrize(("name", "value"), [("side", -0.1), ("noise", 0.0), ("own", float("nan"))])
def test_a_prior_that_nothing_can_be_learned_from_is_refused(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=f"{name} is {value}, must be"):
        Prior(**{**dict.fromkeys(("common", "side", "feed", "type", "own"), 0.1), name: value})
