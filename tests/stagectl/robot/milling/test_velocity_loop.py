"""The inner loop: it follows a velocity without error, whatever constant disturbs it, and does not wind up."""

from dataclasses import replace

import numpy as np
import pytest

from calibration.state_space.model import InnovationModel
from stagectl.robot.milling import velocity_loop_kernel as kernel
from stagectl.robot.milling.feed_record import LOOP
from stagectl.robot.milling.nominal_velocity import nominal_velocity
from stagectl.robot.milling.velocity_loop import VelocityLoop, VelocityWeights, velocity_loop

H = 0.004
MODEL = nominal_velocity(250.0)


def followed(
    loop: VelocityLoop, wanted: np.ndarray, offset: float = 0.0, most: float = 1.0, noise: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Return the velocity, and what the observer takes it for, m/s, of the model with an offset at its input."""
    packed: np.record = np.zeros(1, LOOP).view(np.recarray)[0]
    loop.pack(packed, -most, most, 1.0 / H)
    plant, rng, found = np.zeros(MODEL.order), np.random.default_rng(1), np.zeros((2, len(wanted)))
    for n, each in enumerate(wanted):
        velocity = float((MODEL.C @ plant)[0])
        seen = kernel.observe(packed, velocity + noise * rng.standard_normal())
        kernel.control(packed, each, seen)
        plant = MODEL.A @ plant + MODEL.B[:, 0] * (packed.asked + offset)
        found[:, n] = velocity, seen
    return found[0], found[1]


def test_a_step_is_followed_quickly_with_little_overshoot_and_no_error_left() -> None:
    velocity, _ = followed(velocity_loop(MODEL, VelocityWeights()), np.full(250, 0.01))
    assert velocity[12] > 0.9 * 0.01
    assert velocity.max() < 1.15 * 0.01
    np.testing.assert_allclose(velocity[40:], 0.01, rtol=0.02)
    np.testing.assert_allclose(velocity[-1], 0.01, rtol=1e-6)


def test_a_constant_disturbance_is_found_and_taken_away() -> None:
    velocity, seen = followed(velocity_loop(MODEL, VelocityWeights()), np.full(2000, 0.01), offset=3e-3)
    assert velocity[-1] == pytest.approx(0.01, rel=1e-3)
    assert seen[-1] == pytest.approx(0.01, rel=1e-3)


def test_the_observer_is_quieter_than_the_measurement() -> None:
    velocity, seen = followed(velocity_loop(MODEL, VelocityWeights()), np.full(2000, 0.01), noise=1e-3)
    assert (seen - velocity)[500:].std() < 0.7e-3


def test_the_integral_does_not_wind_up_against_a_limit() -> None:
    loop = velocity_loop(MODEL, VelocityWeights())
    wanted = np.concatenate([np.full(250, 0.05), np.full(250, 0.01)])
    velocity, _ = followed(loop, wanted, most=0.02)
    assert velocity[:250].max() < 0.025
    assert np.abs(velocity[285:] - 0.01).max() < 1e-3


def test_the_lag_is_that_of_the_closed_loop() -> None:
    """The area above a step's response, which a loop of first order with that time constant has too."""
    loop = velocity_loop(MODEL, VelocityWeights())
    velocity, _ = followed(loop, np.ones(500), most=100.0)
    assert H * (1.0 - velocity).sum() == pytest.approx(H / (1.0 - np.exp(-H / loop.lag)), rel=1e-3)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"D": np.ones((1, 1))}, "has a direct term of 1, must be 0"),
        ({"A": np.diag([1.2, 0.5, 0.5])}, "has a pole of size 1.2, must be < 1"),
        ({"C": -MODEL.C}, "has the gain -1 at rest, must be 0.5 to 2"),
    ],
)
def test_a_model_that_is_none_of_a_velocity_is_refused(change: dict[str, np.ndarray], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        velocity_loop(replace(MODEL, **change), VelocityWeights())


def test_a_model_of_two_inputs_or_too_many_states_is_refused() -> None:
    two = InnovationModel(np.eye(1) / 2, np.ones((1, 2)), np.ones((1, 1)), np.zeros((1, 2)), np.zeros((1, 1)), 250.0,
                          np.eye(1))  # fmt: skip
    with pytest.raises(ValueError, match="2 inputs and 1 outputs"):
        velocity_loop(two, VelocityWeights())
    many = InnovationModel(np.eye(9) / 2, np.ones((9, 1)), np.ones((1, 9)), np.zeros((1, 1)), np.zeros((9, 1)), 250.0,
                           np.eye(1))  # fmt: skip
    with pytest.raises(ValueError, match="9 states, must be 1 to 8"):
        velocity_loop(many, VelocityWeights())


@pytest.mark.parametrize("name", ["integral", "effort", "drift", "doubt"])
def test_a_weight_out_of_its_range_is_refused_by_name(name: str) -> None:
    with pytest.raises(ValueError, match=f"{name} is -1, must be finite"):
        VelocityWeights(**{name: -1})
