"""The outer loop's design keeps its bounds, on the model and beside it."""

import numpy as np
import pytest

from stagectl.config import Outer
from stagectl.stage.design import design, mistuned
from stagectl.stage.sensitivity import robustness
from stagectl.stage.state_space import plant_of
from tests.stagectl.linear_stage import RATE, mechanics, model


def test_a_design_keeps_ms_with_the_extra_delay_and_with_frequencies_off_either_way() -> None:
    made = design(model("y"), Outer(bandwidth=(200.0,)), 1)
    loop = made.loop.system()
    for factor in (0.95, 1.0, 1.05):
        figures = robustness(mistuned(plant_of(made.loop.model), factor), loop, RATE, delay=1)
        assert figures.stable
        assert figures.max_sensitivity <= 2.2


def test_a_tighter_bound_costs_suppression() -> None:
    outer = Outer(bandwidth=(400.0,), mistuning=0.0)
    loose, tight = (design(model("z"), outer.model_copy(update={"max_sensitivity": bound}), 2) for bound in (2.2, 1.3))
    assert tight.robustness.max_sensitivity <= 1.3 < loose.robustness.max_sensitivity <= 2.2
    assert tight.suppression > 1.2 * loose.suppression


def test_the_suppression_is_that_of_the_loop_at_the_frequency_asked_for() -> None:
    made = design(model("z"), Outer(disturbance=20.0), 2)
    loop = made.loop.system().then(plant_of(made.loop.model)).response(np.array([20.0]), RATE)[0]
    assert made.suppression == pytest.approx(abs(1 / (1 + loop)), rel=1e-9)


def test_a_mistuned_plant_is_the_one_whose_modes_are_elsewhere() -> None:
    A, B, C = mechanics("x", 1.05)
    moved = mistuned(plant_of(model("x")), 1.05)
    natural = np.sort(np.abs(np.log(np.linalg.eigvals(moved.A).astype(complex)))) * RATE / (2 * np.pi)
    truth = np.sort(np.abs(np.log(np.linalg.eigvals(A).astype(complex)))) * RATE / (2 * np.pi)
    np.testing.assert_allclose(natural[:6], truth, rtol=1e-9)
    at_rest = (C @ np.linalg.solve(np.eye(6) - A, B))[0, 0]
    assert moved.response(np.zeros(1), RATE)[0].real == pytest.approx(at_rest, rel=1e-9)


def test_a_bound_that_cannot_be_kept_says_what_could() -> None:
    with pytest.raises(ValueError, match=r"axis 1: no outer loop keeps .* 1.1 on this model, the least is [\d.]+"):
        design(model("z"), Outer(max_sensitivity=1.1, delay=20, bandwidth=(2_000.0,)), 0)
