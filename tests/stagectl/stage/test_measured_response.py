"""What was heard of a plant bounds loops and prefilters where their model says nothing.

Guards against a model that misses a resonance: the loop must be told by what was measured, not by what was fitted.
"""

from dataclasses import replace

import numpy as np
import pytest

from calibration.state_space.model import InnovationModel
from stagectl.config import Outer
from stagectl.stage.allowed_gains import configured
from stagectl.stage.design import Design, Search, chosen, only
from stagectl.stage.design_refinement import designed
from stagectl.stage.disturbance import disturbance
from stagectl.stage.measured_response import SMALL, MeasuredResponse, near
from stagectl.stage.prefilter import Prefilter, prefilter, refuse_unfit
from stagectl.stage.state_space import plant_of
from tests.stagectl.experiments.piezo.linear_stage import AXES, RATE, RATIO, lagging, model, sampled
from tests.stagectl.stage.test_prefilter import LATE, deflection

CELLS = np.arange(2.0, 800.0)
MISSED = 145.0, 0.006, 0.7
"""Natural frequency (Hz), damping ratio and share of the position at rest, of a mode that no model has."""


def with_missed() -> InnovationModel:
    modes = [(frequency, damping, RATIO * share) for frequency, damping, share in (*AXES["x"], MISSED)]
    return lagging(sampled(modes), 250.0)


def measured(plant: InnovationModel, late: float = 0.0) -> MeasuredResponse:
    """Return what chirps would hear of a plant, and a laser that sees it later than its sensor by `late` s."""
    position = plant.frequency_response(CELLS)[:, 0, 0]
    return MeasuredResponse(CELLS, position, position * (np.exp(-2j * np.pi * CELLS * late) - 1.0))


def found(heard: MeasuredResponse | None) -> Design:
    outer = Outer()
    return chosen(Search(model("x"), outer, 0, configured(outer, 0, RATE), heard))


def test_a_loop_is_as_far_from_the_point_as_on_the_plant_that_was_heard() -> None:
    design = found(None)
    feedback = design.loop.system().response(CELLS, RATE) * plant_of(model("x")).response(CELLS, RATE)
    answers = measured(model("x")).answers(design.loop)
    np.testing.assert_allclose(answers.sensitivity, np.abs(1 / (1 + feedback)), rtol=1e-6)
    np.testing.assert_array_equal(answers.compensation, 0.0)


def test_noise_bounds_nothing() -> None:
    silent = MeasuredResponse(CELLS, np.zeros(len(CELLS), complex), np.zeros(len(CELLS), complex))
    assert found(silent).weights == found(None).weights


def test_a_resonance_that_the_model_misses_keeps_the_loop_slow() -> None:
    heard, outer = measured(with_missed()), Outer()
    before, after = (heard.answers(found(each).loop).sensitivity.max() for each in (None, heard))
    assert before > outer.mistuned_sensitivity
    assert after <= outer.mistuned_sensitivity


def test_a_laser_that_comes_late_keeps_the_gain_from_the_reference_small() -> None:
    heard = measured(model("x"), late=2e-3)
    before, after = (heard.answers(found(each).loop).compensation.max() for each in (None, heard))
    assert before > 1.0
    assert after <= SMALL


@pytest.mark.slow
def test_refining_keeps_to_it_and_a_plant_that_allows_nothing_is_named() -> None:
    heard = measured(model("x"), late=1e-3)
    refined = designed(model("x"), Outer(), 0, measured=heard)
    assert heard.answers(refined.loop).compensation.max() <= SMALL
    hopeless = replace(heard, seen=1e3 * np.ones(len(CELLS), complex))
    search = Search(model("x"), Outer(), 0, configured(Outer(), 0, RATE), hopeless)
    reached = search.reached(next(search.candidates(only(found(None).weights))))
    assert reached.over(Outer()) > 1.0
    assert "is deflection.delay right?" in reached.binding(Outer())
    assert "compensation" in str(reached)


def made(heard: MeasuredResponse | None) -> Prefilter:
    filters = prefilter(found(None), Outer(), disturbance(deflection(1), RATE), LATE, heard)
    assert filters is not None
    return filters


def gain(filters: Prefilter, heard: MeasuredResponse) -> float:
    """Return the compensation's largest gain with a filter."""
    led = replace(found(None).loop, forward=filters.forward)
    return float(np.max(heard.answers(led).compensation * np.abs(filters.response(CELLS, RATE))))


@pytest.mark.slow
def test_a_prefilter_leaves_alone_what_laser_and_sensor_see_differently_where_the_model_misses_it() -> None:
    """The shapes of a drawn stage that swung: the model of its plate had no resonance there."""
    heard = measured(with_missed(), late=2e-4)
    unaware, aware = made(None), made(heard)
    assert gain(unaware, heard) > 1.0
    assert gain(aware, heard) < 1.05 * SMALL
    assert aware.left < 0.8 * aware.without, "it is worth something still"
    refuse_unfit(aware, found(None), Outer(), LATE, "filters", heard)
    with pytest.raises(ValueError, match=r"filters belongs to another loop"):
        refuse_unfit(unaware, found(None), Outer(), LATE, "filters", heard)


@pytest.mark.parametrize(
    ("what", "said"),
    [
        ({"frequency": CELLS[::-1]}, "must be > 0 and rise"),
        ({"frequency": CELLS[1:]}, r"has the shapes \(797,\), \(798,\), \(798,\), must be"),
        ({"position": np.full(len(CELLS), np.nan + 0j)}, "not finite everywhere"),
    ],
)
def test_what_is_no_response_is_refused(what: dict[str, np.ndarray], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        replace(measured(model("x")), **what)


def test_near_is_a_part_of_the_frequency_and_a_width_below() -> None:
    low, high = near(CELLS, np.array([100.0, 1000.0]), 0.02, 1.0)
    assert CELLS[low[0] : high[0]].tolist() == [97.0, 98.0, 99.0, 100.0, 101.0, 102.0]
    assert low[1] == high[1] == len(CELLS)
