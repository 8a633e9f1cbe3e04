"""A pocket that cannot be is refused, by the name of what is wrong."""

from typing import Any

import pytest

from stagectl.planning.problem import Pocket, PocketFault
from tests.stagectl.planning.pockets import EXAMPLE


def _with(**changed: Any) -> dict[str, Any]:
    return {**EXAMPLE, **changed}


def _rate(**changed: Any) -> dict[str, Any]:
    return _with(rate={**EXAMPLE["rate"], **changed})


def test_thirds_have_ten_types_halves_six_and_twelve_in_four_directions() -> None:
    assert len(Pocket.from_dict(EXAMPLE).types) == 10
    halves = {f"{feed}{k}": 1.0 for feed in "EW" for k in ("2", "1u", "1d")}
    assert len(Pocket(4, 4, 2, "EW", halves).types) == 6
    assert (
        len(Pocket(4, 4, 2, "EWNS", {**halves, "N2": 1, "N1u": 1, "N1d": 1, "S2": 1, "S1u": 1, "S1d": 1}).types) == 12
    )


def test_what_is_not_said_is_free_and_walled() -> None:
    short = {key: EXAMPLE[key] for key in ("rows", "cols", "G", "feeds", "rate")}
    pocket = Pocket.from_dict(short)
    assert (pocket.closed, pocket.t_acc, pocket.step, pocket.t_lift, pocket.v_lift) == (True, 0.0, 0.0, 0.0, None)


def test_what_is_paid_takes_the_place_of_what_is_believed() -> None:
    pocket = Pocket.from_dict(_with(true={"rate": {"E3": 1.0}, "W3": 2.0, "theta": {"N": 1.4}, "v_lift": None}))
    paid = pocket.paid()
    assert (paid.rate["E3"], paid.rate["W3"], paid.rate["E2u"]) == (1.0, 2.0, 0.0484)
    assert paid.theta == {"N": 1.4}
    assert paid.v_lift is None
    assert paid.true == {}
    assert pocket.rate["E3"] == 0.075


@pytest.mark.parametrize(
    ("given", "text"),
    [
        (_rate(E3=-1.0), "rate[E3] is -1.0 s per cell, must be a number > 0"),
        (_rate(E3=float("nan")), "rate[E3] is nan s per cell"),
        (_rate(E3=float("inf")), "rate[E3] is inf s per cell"),
        (_rate(E3=0), "rate[E3] is 0 s per cell"),
        (_rate(E3="fast"), "rate[E3] is 'fast' s per cell"),
        (_rate(N3=1.0), "rate has 'N3', must be of E3, E2u, E2d, E1u, E1d, W3"),
        (_with(rate={"E3": 1.0}), "rate has no E2u, E2d, E1u, E1d, W3, W2u, W2d, W1u, W1d, must have all of"),
        (_with(rate=[1.0]), "rate is [1.0], must be a table"),
        (_with(rows=2), "rows is 2, smaller than the tool, must be >= G, 3 cells"),
        (_with(cols=2), "cols is 2, smaller than the tool"),
        (_with(rows=30.0), "rows is 30.0, must be a whole number of cells"),
        (_with(G=0), "G is 0, must be a whole number of cells, 1 to 9"),
        (_with(feeds="NS"), "feeds is 'NS', must be one of EW, EWNS"),
        (_with(closed=1), "closed is 1, must be true or false"),
        (_with(t_acc=-0.1), "t_acc is -0.1 s, must be a number >= 0"),
        (_with(step=float("nan")), "step is nan s"),
        (_with(t_lift=True), "t_lift is True s"),
        (_with(v_lift=0), "v_lift is 0 cells/s, must be a number > 0 or null"),
        (_with(theta={"W": 2.0}), "theta has 'W', must be of N, S"),
        (_with(theta={"N": 0.0}), "theta[N] is 0.0, must be a number > 0"),
        (_with(true={"rows": 3}), "true has 'rows', must be of rate, theta"),
        (_with(true={"E3": -1}), "true: rate[E3] is -1"),
        (_with(true={"rate": 3}), "true: rate is 3, must be a table"),
        (_with(size=3), "the pocket has 'size', must be of rows, cols"),
        ({"rows": 3}, "the pocket has no cols, G, feeds, rate"),
        ([1], "a pocket is list, must be a table"),
    ],
)
def test_a_pocket_that_cannot_be_is_refused_by_name(given: Any, text: str) -> None:
    with pytest.raises(PocketFault) as fault:
        Pocket.from_dict(given)
    assert text in str(fault.value)
