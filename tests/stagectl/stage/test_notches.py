"""Notches around narrow resonances: what they pass, the loop made with them, and that loop in its limits."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from stagectl.config import Outer, StageConfig
from stagectl.stage import notches as module
from stagectl.stage.design import Design, design
from stagectl.stage.design_bounds import mistuned
from stagectl.stage.loop import stage_controller
from stagectl.stage.notches import behind, notches, with_notches
from stagectl.stage.servo import servo
from stagectl.stage.state_feedback import StateFeedback, linear_quadratic
from stagectl.stage.state_space import plant_of
from stagectl.stage.weights import chosen_weights
from tests.stagectl.experiments.piezo.linear_stage import (
    INNER,
    LIMITS,
    RATE,
    Bench,
    LinearStage,
    lagging,
    model,
    sampled,
    two_near_one_another,
)

FREQUENCY = np.array([0.1, 5.0, 30.0, 107.0, 110.0, 114.0, 300.0, 4_000.0])


NEAR = 109.34, 111.82
"""Hz, the resonances of `two_near_one_another`."""


@cache
def found() -> Design:
    return design(two_near_one_another(), Outer(), 0)


def bench(factor: float = 1.0) -> Bench:
    """Return the loop on a plate whose frequencies are off by a factor, started and at rest."""
    config = StageConfig(inner=INNER, limits=LIMITS)
    config = config.model_copy(update={"stage": config.stage.model_copy(update={"axes": ("x",)})})
    plant = LinearStage(("x",))
    off = mistuned(plant_of(two_near_one_another()), factor)
    plant.parts = [(off.A, off.B, off.C)]
    made = Bench(config, stage_controller(config, [found().loop]), plant)
    made.run(0.4)
    made.reference.value[:] = 225e-6
    made.stage.start()
    made.run(1.0)
    return made


def test_they_stop_what_is_near_a_resonance_and_pass_what_is_far_from_it() -> None:
    notch = notches(two_near_one_another(), 0.05, 0.8)
    assert notch is not None
    gain = np.abs(notch.response(np.array([0.0, 0.98 * NEAR[0], 110.6, 1.02 * NEAR[1], 4_999.0]), RATE))
    np.testing.assert_allclose(gain[[0, 4]], 1.0, atol=1e-3)
    assert gain[1:4].max() < 0.0025


def test_resonances_that_cannot_be_taken_for_one_another_have_notches_each() -> None:
    apart = notches(lagging(sampled([(60.0, 0.01, 1.0), (150.0, 0.02, 1.0)]), 250.0), 0.05, 0.8)
    assert apart is not None
    assert len(apart.A) == 8
    assert np.abs(apart.response(np.array([0.98 * 60.0, 0.98 * 150.0]), RATE)).max() < 0.03


def test_there_are_none_for_a_resonance_that_is_known_well_enough_or_where_there_is_no_room(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert notches(model("z"), 0.015, 0.8) is None
    monkeypatch.setattr(module, "MOST_STATES", 7)
    assert notches(two_near_one_another(), 0.05, 0.8) is None


def test_the_loop_is_the_one_that_was_made_for_the_plant_behind_them_and_the_notches() -> None:
    known = two_near_one_another()
    notch = notches(known, 0.05, 1.2)
    assert notch is not None
    states = servo(Outer(), 20.0, RATE)
    feedback, servo_feedback = linear_quadratic(behind(notch, known), states, 0.5)
    gain = np.vstack([np.full((known.order, 1), 0.01), np.zeros((len(notch.A), 1))])
    inside = StateFeedback(behind(notch, known), gain, feedback, states, servo_feedback, 0.3)
    loop = with_notches(inside, notch, known)
    for made, apart in (
        (loop.system(), inside.system()),
        (loop.reference_system(), inside.reference_system()),
    ):
        np.testing.assert_allclose(
            made.response(FREQUENCY, RATE), apart.then(notch).response(FREQUENCY, RATE), rtol=1e-6
        )


@pytest.mark.slow
def test_the_design_finds_a_loop_with_them_where_there_is_none_without() -> None:
    assert found().weights.notch > 0
    assert found().worst_sensitivity <= 3.0
    assert found().left < 1.0
    again = design(two_near_one_another(), Outer(), 0, found().weights)
    np.testing.assert_allclose(again.loop.feedback, found().loop.feedback, rtol=1e-9)
    with pytest.raises(ValueError, match="there is no LQ gain for this model"):
        design(replace(model("z")), Outer(mistuning=0.01), 2, found().weights)


@pytest.mark.slow
@pytest.mark.parametrize("factor", [0.955, 1.0, 1.045])
def test_a_plate_whose_resonances_are_elsewhere_follows_and_does_not_ring(factor: float) -> None:
    made = bench(factor)
    made.reference.value[:] += 10e-6
    position = made.run(1.0)["position"][:, 0]
    np.testing.assert_allclose(position[-1_000:], made.reference.value[0], atol=0.1e-6)


def test_what_winds_up_in_the_limits_unwinds_while_the_plate_still_rings() -> None:
    """The limits shake the resonance, which the loop lets alone: it dies out by itself."""
    made = bench()
    before = made.run(0.01)["extension_reference"].mean()
    made.reference.value[:] = 450e-6
    made.run(0.5)
    assert made.stage.controller.met.extension[0] > 100
    made.reference.value[:] = 225e-6
    after = made.run(0.6)
    assert np.ptp(after["position"][-1_000:]) > 1e-6
    np.testing.assert_allclose(after["extension_reference"][-1_000:], before, atol=0.1e-6)


def test_a_rig_file_from_before_there_were_any_has_none() -> None:
    given = {"bandwidth": (50.0,) * 3, "drive": (1.0,) * 3, "trust": (1.0,) * 3, "doubt": (0.0,) * 3}
    rig = StageConfig.model_validate({"weights": {**given, "caution": (0.0,) * 3, "feedforward": (1.0,) * 3}})
    weights = chosen_weights(rig.weights, 1)
    assert weights is not None
    assert weights.notch == 0.0
