"""A refined design leaves less error and keeps the same bounds; one is found between the weights of the grid, too."""

import pytest

from stagectl.config import Outer
from stagectl.stage import design as design_module
from stagectl.stage import design_refinement
from stagectl.stage.allowed_gains import configured
from stagectl.stage.design import NoLoop, Search, design
from stagectl.stage.design_refinement import designed, refined
from tests.stagectl.experiments.piezo.linear_stage import RATE, model


def test_it_leaves_less_error_within_the_same_bounds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(design_refinement, "LOOKS", 60)
    outer = Outer(bandwidth=(100.0,), max_sensitivity=1.5)
    coarse = design(model("z"), outer, 2)
    fine = refined(coarse, Search(model("z"), outer, 2, configured(outer, 2, RATE)))
    assert fine.left < 0.95 * coarse.left
    assert fine.robustness.max_sensitivity <= 1.5
    assert fine.worst_sensitivity <= 3.0
    assert fine.weights.bandwidth <= 100.0
    again = design(model("z"), outer, 2, fine.weights)
    assert again.left == pytest.approx(fine.left)


@pytest.mark.slow
def test_between_weights_of_which_none_keeps_the_bounds_one_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(design_module, "NOTCHES", ())
    monkeypatch.setattr(design_refinement, "LOOKS", 150)
    outer = Outer(bandwidth=(100.0,), mistuning=0.2, mistuned_sensitivity=1.1)
    with pytest.raises(NoLoop) as fault:
        design(model("z"), outer, 2)
    found = designed(model("z"), outer, 2)
    assert found.worst_sensitivity <= 1.1
    assert fault.value.nearest is not None
    assert found.left < fault.value.nearest.left
    assert found.weights.bandwidth <= 100.0
    assert design(model("z"), outer, 2, found.weights).left == pytest.approx(found.left)


def test_where_there_is_none_between_them_either_the_nearest_of_the_grid_is_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(design_module, "NOTCHES", ())
    with pytest.raises(NoLoop, match=r"none of 2400 .* has gains .* and 7.4 of those allowed.* are Ms 2.2, mist"):
        designed(model("z"), Outer(bandwidth=(100.0,), forward_beyond=0.003), 2)
