"""The outer loop's design keeps its bounds, on the model and beside it."""

from dataclasses import replace

import numpy as np
import pytest

from stagectl.config import Outer
from stagectl.stage import design as design_module
from stagectl.stage.allowed_gains import configured
from stagectl.stage.design import SHARES, NoLoop, design
from stagectl.stage.design_bounds import Looks, Reached, mistuned
from stagectl.stage.kalman import kalman_gain
from stagectl.stage.sensitivity import robustness
from stagectl.stage.state_space import plant_of
from stagectl.stage.weights import loops
from tests.stagectl.experiments.piezo.linear_stage import RATE, mechanics, model, two_near_one_another


def test_a_design_keeps_ms_with_the_extra_delay_and_with_frequencies_off_either_way() -> None:
    made = design(model("y"), Outer(), 1)
    loop = made.loop.system()
    for factor, bound in ((0.95, 3.0), (1.0, 2.2), (1.05, 3.0)):
        figures = robustness(mistuned(plant_of(made.loop.model), factor), loop, RATE, delay=1)
        assert figures.stable
        assert figures.max_sensitivity <= bound


def test_no_reference_is_answered_more_than_allowed_with_frequencies_off_either_way() -> None:
    """A feedforward that excites a mode which feedback does not damp is the danger."""
    made = design(model("y"), Outer(mistuned_sensitivity=2.5, beyond=(1.0,)), 1)
    frequency = np.linspace(1.0, 200.0, 4_000)
    for factor in (0.95, 1.0, 1.05):
        plant = mistuned(plant_of(made.loop.model), factor).response(frequency, RATE)
        loop = 1 + made.loop.system().response(frequency, RATE) * plant
        answer = made.loop.reference_system().response(frequency, RATE) * plant / loop
        assert np.abs(answer).max() <= 2.55


def test_the_controllers_gain_is_small_where_the_model_does_not_reach() -> None:
    made = design(model("z"), Outer(reach=150.0, beyond=(0.7,)), 2)
    gain = made.loop.system().response(np.linspace(150.0, 4_999.0, 2_000), RATE)
    at_rest = plant_of(made.loop.model).response(np.zeros(1), RATE)
    assert 0.3 < np.abs(gain).max() * abs(at_rest[0]) <= 0.705


def test_a_reference_does_not_shake_what_the_model_leaves_out() -> None:
    """A laser's steps come through the feedforward, up to any frequency."""
    made = design(model("y"), Outer(forward_beyond=5.0), 1)
    gain = made.loop.reference_system().response(np.linspace(200.0, 4_999.0, 2_000), RATE)
    at_rest = plant_of(made.loop.model).response(np.zeros(1), RATE)
    assert 1.0 < np.abs(gain).max() * abs(at_rest[0]) <= 5.02


def test_a_tighter_bound_leaves_more_error() -> None:
    loose, tight = (design(model("z"), Outer(mistuning=0.0, max_sensitivity=bound), 2) for bound in (2.2, 1.2))
    assert tight.robustness.max_sensitivity <= 1.2 < loose.robustness.max_sensitivity <= 2.2
    assert tight.left > loose.left


def test_what_is_left_is_that_of_the_closed_loop() -> None:
    made = design(model("z"), Outer(disturbance=20.0), 2)
    without, forward = made.loop.from_reference()
    at = np.array([20.0, 60.0])
    missed = np.abs(1 - without.response(at, RATE) - made.loop.forward * forward.response(at, RATE))
    loop = made.loop.system().then(plant_of(made.loop.model)).response(np.array([2.0]), RATE)[0]
    assert made.left == pytest.approx(np.linalg.norm([missed[0], missed[1] / 3, abs(1 / (1 + loop))]), rel=1e-6)


def test_forces_that_count_move_the_plate_less_and_the_rest_keeps_its_bounds() -> None:
    """At 10 and 30 Hz, as the error that is left says."""
    outer, plant, at = Outer(compliance=2.0), plant_of(model("z")), np.array([10.0, 30.0])
    gives, made = [], [design(model("z"), each, 2) for each in (Outer(), outer)]
    for each in made:
        response = plant.response(at, RATE)
        answer = np.abs(response / (1 + each.loop.system().response(at, RATE) * response))
        gives.append(np.linalg.norm(answer) / abs(plant.response(np.zeros(1), RATE)[0]))
    assert gives[1] < 0.85 * gives[0]
    assert made[1].robustness.max_sensitivity <= outer.max_sensitivity
    without = Looks([plant], RATE, Outer(), configured(Outer(), 2, RATE)).beyond_and_left(made[1].loop)[1]
    assert made[1].left == pytest.approx(np.hypot(without, 2.0 * gives[1]), rel=1e-3)


def test_pushes_that_count_leave_a_loop_that_rings_less_and_hardly_more_error() -> None:
    """A push at the input, at any frequency, on the plant that the loop is made for."""
    plant, frequency = plant_of(model("y")), np.linspace(20.0, 200.0, 4_000)
    largest = []
    for push in (0.0, 0.1):
        made = design(model("y"), Outer(push=push), 1)
        response = plant.response(frequency, RATE)
        answer = response / (1 + made.loop.system().response(frequency, RATE) * response)
        largest.append(np.abs(answer).max() / abs(plant.response(np.zeros(1), RATE)[0]))
        error = made.left if push == 0.0 else np.sqrt(made.left**2 - (push * largest[-1]) ** 2)
        assert error < 0.75
    assert largest[1] < 0.6 * largest[0]


def test_a_mistuned_plant_is_the_one_whose_modes_are_elsewhere() -> None:
    A, B, C = mechanics("x", 1.05)
    moved = mistuned(plant_of(model("x")), 1.05)
    natural = np.sort(np.abs(np.log(np.linalg.eigvals(moved.A).astype(complex)))) * RATE / (2 * np.pi)
    truth = np.sort(np.abs(np.log(np.linalg.eigvals(A).astype(complex)))) * RATE / (2 * np.pi)
    np.testing.assert_allclose(natural[:6], truth, rtol=1e-9)
    at_rest = (C @ np.linalg.solve(np.eye(6) - A, B))[0, 0]
    assert moved.response(np.zeros(1), RATE)[0].real == pytest.approx(at_rest, rel=1e-9)


def test_bounds_that_cannot_be_kept_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(design_module, "NOTCHES", ())  # which are none the better, and take as long again
    with pytest.raises(
        ValueError, match=r"none of \d+ outer loops .* has gains .* 6.3 and .* of those allowed.* are Ms 1.1, mist"
    ):
        design(model("z"), Outer(beyond=(1e-5,), max_sensitivity=1.1, delay=20, mistuning=0.3), 2)


def test_a_resonance_narrower_than_its_frequency_is_known_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(design_module, "NOTCHES", ())
    with pytest.raises(
        NoLoop, match=r"resonance at 111.8 Hz has a damping ratio of 0.0022, and .* outer.mistuning, 0.05"
    ):
        design(two_near_one_another(), Outer(), 0)


def test_a_loop_that_is_stable_where_frequencies_are_right_is_told_from_one_that_never_is() -> None:
    plant = two_near_one_another()
    looks = Looks(
        [mistuned(plant_of(plant), factor) for factor in (1.0, 0.95, 1.05)], RATE, Outer(), configured(Outer(), 0, RATE)
    )
    _, loop = next(loops(plant, Outer(), SHARES))
    found = looks.reached(loop, Reached(0.0, 0.0, 0.0, 0.0))
    assert found.sensitivity < 10.0
    assert found.mistuned_sensitivity == np.inf


def test_where_nothing_of_what_is_asked_for_keeps_the_bounds_a_fainter_loop_is_found() -> None:
    faint = design(model("z"), Outer(beyond=(0.001,)), 2)
    assert faint.robustness.max_sensitivity <= 2.2
    assert faint.weights.bandwidth < min(200.0 * share for share in SHARES.bandwidth)


def test_chosen_weights_make_the_loop_that_was_chosen() -> None:
    chosen = design(model("z"), Outer(), 2)
    again = design(model("z"), Outer(), 2, chosen.weights)
    np.testing.assert_allclose(again.loop.feedback, chosen.loop.feedback, rtol=1e-9)
    np.testing.assert_allclose(again.loop.gain, chosen.loop.gain, rtol=1e-9)
    assert again.loop.forward == pytest.approx(chosen.loop.forward)


def test_chosen_weights_that_do_not_keep_the_bounds_are_refused_with_what_they_reach() -> None:
    chosen = design(model("z"), Outer(), 2)
    with pytest.raises(ValueError, match=r"axis 3: the loop of \[weights\] .* Ms 1.\d\d, .* allowed are Ms 1.1, mist"):
        design(model("z"), Outer(max_sensitivity=1.1), 2, chosen.weights)


def test_an_identified_gain_that_trusts_every_sensor_is_not_in_the_way_of_a_design() -> None:
    """A gain from loud chirps, where the plate drowns the sensor's noise: the filter takes all it sees for motion."""
    known = model("z")
    gain = kalman_gain(replace(known, K=np.zeros_like(known.K)), 1e4)
    loud = replace(known, K=gain)
    assert np.abs(np.linalg.eigvals(known.A - gain @ known.C)).max() < 1.0
    assert design(loud, Outer(), 2).weights.trust < 1.0
