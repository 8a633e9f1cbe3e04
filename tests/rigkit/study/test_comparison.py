"""Two results of a study, task by task."""

from dataclasses import replace

import pytest

from rigkit.study.comparison import difference, ends_differently, is_within, matched
from tests.rigkit.study.test_summary import FIGURES, ROWS, WORD, WORST


def test_the_same_results_do_not_differ() -> None:
    pairs = matched(ROWS, [replace(row, wall=9.0, host="elsewhere", key="other") for row in reversed(ROWS)])
    found = {name: difference(pairs, name, figure) for name, figure in FIGURES.items()}
    assert len(pairs) == len(ROWS)
    assert ends_differently(pairs) == []
    assert is_within(found, FIGURES, 0.0)


def test_the_largest_difference_is_named_by_its_task() -> None:
    others = [replace(row, figures={**row.figures, "db": -9.9}) if row is ROWS[0] else row for row in ROWS]
    found = difference(matched(ROWS, others), "db", WORST)
    assert (found.count, found.differing, found.worst) == (5, 1, ROWS[0])
    assert found.largest == pytest.approx(0.9 / 9.9)
    assert is_within({"db": found}, FIGURES, 0.1)
    assert not is_within({"db": found}, FIGURES, 0.09)


def test_a_figure_that_only_one_has_and_another_word_differ_wholly() -> None:
    others = [replace(row, status=1, figures={**row.figures, "db": None, "why": "no"}) for row in ROWS]
    pairs = matched(ROWS, others)
    assert difference(pairs, "db", WORST).largest == float("inf")
    assert difference(pairs, "why", WORD).differing == 6
    assert len(ends_differently(pairs)) == len(ROWS)


def test_results_without_a_task_in_common_are_refused() -> None:
    with pytest.raises(ValueError, match="no task in common"):
        matched(ROWS, [replace(row, seed=row.seed + 10) for row in ROWS])
