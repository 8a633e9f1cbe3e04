"""A path is held against the rules, each of which is broken once."""

from typing import Any

import pytest

from stagectl.planning.pocket import check, plan
from stagectl.planning.problem import Pocket
from tests.stagectl.planning.pockets import EXAMPLE

RATE = {f"{feed}{k}": 1.0 for feed in "EWNS" for k in ("2", "1u", "1d")}
CLOSED = Pocket(6, 5, 2, "EWNS", RATE, t_acc=0.5, step=0.1, t_lift=2.0, v_lift=2.0, theta={"S": 1.5})
OPEN = Pocket(6, 5, 2, "EWNS", RATE, closed=False)


def test_the_cost_of_a_path_is_that_of_its_segments_moves_and_lifts() -> None:
    path = [
        ["E2", 0, 0, "E"],  # 0.5 + 5
        ["W1u", 1, 3, "W"],  # a serpentine of 1 cell: 0.1; 0.5 + 5
        ["S1u", 3, -1 + 0, "S"],
    ]
    assert check(CLOSED, path[:2]).total == pytest.approx(11.1)
    assert check(CLOSED, path).error == "segment 3: the tool at row 3, col -1 crosses a wall of 6 x 5 cells"
    turned = check(CLOSED, [*path[:2], ["S2", 3, 0, "S"]])  # round the corner, 2 cells: 0.2; 0.5 + 3
    assert turned.total == pytest.approx(11.1 + 3.7)
    lifted = check(CLOSED, [*path[:2], ["E2", 4, 0, "E"]])  # to the south, 3 cells: 2 + 1.5; 0.5 + 1.5 x 5
    assert lifted.total == pytest.approx(11.1 + 3.5 + 8.0)
    assert lifted.error is None
    assert (lifted.complete, lifted.left) == (False, 5)


def test_the_last_slot_counts_as_cut_from_the_side_that_costs_less() -> None:
    path = [["E2", 0, 0, "E"], ["W2", 2, 3, "W"], ["E2", 4, 0, "E"]]
    verdict = check(CLOSED, path)
    assert verdict.complete
    assert verdict.total == pytest.approx(3 * 5.5 + 2 * 0.2)  # off the north, with neither lift nor theta


@pytest.mark.parametrize(
    ("path", "fault"),
    [
        ([["E3", 0, 0, "E"]], "segment 1: type 'E3' must be of E2"),
        ([["E2", 0, 0, "W"]], "segment 1: feed 'W' of a E2 must be E"),
        ([["E2", 0, 0]], "must be a list of type, row, col and feed"),
        (["E2"], "must be a list of type, row, col and feed"),
        ([["E2", 0.0, 0, "E"]], "row 0.0 must be a whole number"),
        ([["E1d", -1, 0, "E"]], "crosses a wall"),
        ([["E1u", 0, 0, "E"]], "mills 2 rows, must be 1"),
        ([["N2", 4, 1, "N"]], "leaves material on both sides"),
        ([["E2", 1, 0, "E"]], "leaves material on both sides"),
        ([["E2", 0, 1, "E"]], "starts at col 1, must be 0, the end of the strip"),
        ([["N2", 3, 0, "N"]], "starts at row 3, must be 4, the end of the strip"),
        ([["E2", 0, 0, "E"], ["W2", 0, 3, "W"]], "segment 2: W2 at row 0, col 3 mills 0 rows, must be 2"),
        ([["E2", 0, 0, "E"], ["W1d", 1, 3, "W"]], "segment 2: W1d off the N side"),
        ([["N2", 4, 0, "N"], ["S1d", 0, 1, "S"]], "off the W side has its material on the other hand, must be S1u"),
    ],
)
def test_a_fault_names_its_segment_and_the_rule(path: list[Any], fault: str) -> None:
    verdict = check(CLOSED, path)
    assert verdict.error is not None
    assert fault in verdict.error
    assert not verdict.complete


def test_a_strip_in_the_middle_of_the_footprint_is_refused() -> None:
    pocket = Pocket.from_dict({**EXAMPLE, "rows": 3, "cols": 3, "closed": False})
    assert check(pocket, [["E2u", 1, 0, "E"], ["W1d", -2, 0, "W"]]).complete is False
    verdict = check(pocket, [["E2u", 1, 0, "E"], ["W1d", -1, 0, "W"]])
    assert verdict.error == "segment 2: the strip of W1d must lie along an edge of the tool's footprint"


def test_without_walls_the_tool_may_overhang() -> None:
    assert check(OPEN, [["E1d", -1, 0, "E"]]).error is None
    assert check(OPEN, [["E1d", -1, 0, "E"]]).left == 25


def test_what_is_really_paid_counts() -> None:
    slow = Pocket.from_dict({**EXAMPLE, "true": {"E3": 0.15, "theta": {"N": 2.0}, "t_acc": 1.0}})
    assert check(slow, [["E3", 0, 0, "E"]]).total == pytest.approx(1.0 + 30 * 0.15 * 2.0)
    assert check(slow, [["E3", 27, 0, "E"]]).total == pytest.approx(1.0 + 30 * 0.15)


def test_an_empty_path_leaves_everything() -> None:
    assert (check(CLOSED, []).left, check(CLOSED, []).complete) == (30, False)
    assert check(CLOSED, plan(CLOSED, "exact")).complete
