"""A refined design leaves less error and keeps the same bounds."""

import pytest

from stagectl.config import Outer
from stagectl.stage import design_refinement
from stagectl.stage.design import design
from stagectl.stage.design_refinement import refined
from tests.stagectl.linear_stage import model


def test_it_leaves_less_error_within_the_same_bounds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(design_refinement, "LOOKS", 60)
    outer = Outer(bandwidth=(100.0,), max_sensitivity=1.5)
    coarse = design(model("z"), outer, 2)
    fine = refined(coarse, model("z"), outer, 2)
    assert fine.left < 0.95 * coarse.left
    assert fine.robustness.max_sensitivity <= 1.5
    assert fine.worst_sensitivity <= 3.0
    assert fine.weights.bandwidth <= 100.0
    again = design(model("z"), outer, 2, fine.weights)
    assert again.left == pytest.approx(fine.left)
