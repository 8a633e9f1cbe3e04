"""The page of the simulators' own figures belongs to what is kept, and a figure that grew worse is told."""

import json

import numpy as np
import pytest

from benchmarks.home import FIGURES, KEPT, PAGE, Figure, page, worse


def test_the_page_is_the_one_that_the_kept_figures_give() -> None:
    """`python -m benchmarks.home --write` writes it."""
    assert PAGE.read_text(encoding="utf-8") == page(json.loads(KEPT.read_text()))


@pytest.mark.parametrize("figure", FIGURES, ids=lambda each: each.key)
def test_a_figure_that_is_six_percent_worse_is_told_and_one_that_is_better_is_not(figure: Figure) -> None:
    before = {each.key: -15.0 if each.is_level else 3.0 for each in FIGURES}
    for change, is_told in ((1.06, True), (1.04, False), (0.5, False)):
        was, times = before[figure.key], 1 / change if figure.is_gain else change
        lines = worse(before, before | {figure.key: was + 20 * np.log10(times) if figure.is_level else was * times})
        assert len(lines) == is_told
        assert all(figure.title in line for line in lines)


def test_what_was_zero_and_is_not_any_more_is_worse() -> None:
    before = {each.key: 0.0 for each in FIGURES}
    assert worse(before, before) == []
    assert len(worse(before, before | {FIGURES[0].key: 1.0})) == 1
