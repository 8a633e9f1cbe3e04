"""The filter, the LQ gains and the feedforward against what they must do by theory."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

from calibration.state_space.model import InnovationModel
from stagectl.config import Outer
from stagectl.stage.kalman import kalman_gain
from stagectl.stage.servo import servo
from stagectl.stage.state_feedback import StateFeedback, linear_quadratic, ramp_feedforward
from stagectl.stage.state_space import plant_of
from tests.stagectl.experiments.piezo.linear_stage import RATE, model


def loop(outer: Outer, bandwidth: float = 60.0, axis: str = "x") -> StateFeedback:
    stage = model(axis)
    states = servo(outer, bandwidth, RATE)
    feedback, servo_feedback = linear_quadratic(stage, states, 1.0)
    return StateFeedback(stage, kalman_gain(stage, 0.1), feedback, states, servo_feedback)


def test_without_doubt_the_filter_is_the_identified_one() -> None:
    stage = model("y")
    identified = replace(stage, K=kalman_gain(stage, 0.3))
    np.testing.assert_allclose(kalman_gain(identified, 0.0), identified.K, rtol=1e-6)


def test_doubt_makes_the_filter_faster() -> None:
    stage = model("z")
    slowest = [
        np.abs(np.linalg.eigvals(stage.A - kalman_gain(stage, doubt) @ stage.C)).max() for doubt in (0.0, 0.1, 10.0)
    ]
    assert slowest[0] > slowest[1] > slowest[2]


def test_with_a_cheap_drive_the_loop_is_as_fast_as_the_integral_is_weighted() -> None:
    """The slowest pole of the regulator is near 2 pi x bandwidth where drive costs next to nothing."""
    stage = model("z")
    states = servo(Outer(), 20.0, RATE)
    feedback, servo_feedback = linear_quadratic(stage, states, 1e3)
    A = np.block([[stage.A, np.zeros((stage.order, 1))], [-states.B @ stage.C, states.A]])
    B = np.vstack([stage.B, np.zeros((1, 1))])
    poles = np.linalg.eigvals(A - B @ np.hstack([feedback, servo_feedback]))
    slowest = np.abs(np.log(poles.astype(complex))).min() * RATE / (2 * np.pi)
    assert slowest == pytest.approx(20.0, rel=0.02)


def test_the_gains_satisfy_the_riccati_equation_with_a_direct_term() -> None:
    """A cost on y = C x + D u has a cross term; without it the gain would be another."""
    stage = replace(model("z"), D=np.full((1, 1), 0.5))
    states = servo(Outer(), 20.0, RATE)
    feedback, _ = linear_quadratic(stage, states, 1.0)
    A = np.block([[stage.A, np.zeros((stage.order, 1))], [-states.B @ stage.C, states.A]])
    B = np.vstack([stage.B, -states.B @ stage.D])
    C = np.hstack([stage.C, np.zeros((1, 1))])
    Q = C.T @ C + np.diag([0.0] * stage.order + [states.weight[0]])
    R = np.full((1, 1), 1.25)
    cost = solve_discrete_are(A, B, Q, R, s=C.T * 0.5)
    np.testing.assert_allclose(
        feedback, np.linalg.solve(B.T @ cost @ B + R, B.T @ cost @ A + 0.5 * C)[:, : stage.order], rtol=1e-9
    )


def test_a_constant_reference_is_met_exactly_and_feedforward_does_not_matter_for_it() -> None:
    without, forward = loop(Outer()).from_reference()
    rest = np.zeros(1)
    assert without.response(rest, RATE)[0] == pytest.approx(1.0, abs=1e-6)
    assert forward.response(rest, RATE)[0] == pytest.approx(0.0, abs=1e-6)


def test_with_the_ramp_feedforward_a_moving_reference_is_met_as_well() -> None:
    designed = loop(Outer())
    designed = replace(designed, forward=ramp_feedforward(designed))
    without, forward = designed.from_reference()
    frequency = np.array([0.5, 1.0])
    error = np.abs(1 - without.response(frequency, RATE) - designed.forward * forward.response(frequency, RATE))
    assert error[1] / error[0] == pytest.approx(4.0, rel=0.05), "the error must grow with the square of frequency"
    plain = np.abs(1 - without.response(frequency, RATE))
    assert plain[1] / plain[0] == pytest.approx(2.0, rel=0.05)


def test_a_resonant_state_leaves_nothing_of_a_disturbance_at_its_frequency() -> None:
    designed = loop(Outer(resonances=(95.0,)))
    gain = designed.system().then(plant_of(designed.model)).response(np.array([94.0, 95.0 + 1e-6]), RATE)
    assert abs(1 / (1 + gain[1])) < 1e-4
    assert abs(1 / (1 + gain[0])) > 0.01


def test_the_servo_states_follow_a_limited_input_as_fast_as_they_are_weighted() -> None:
    designed = loop(Outer(resonances=(95.0,)), bandwidth=30.0)
    tracking = designed.servo.tracking(designed.servo_feedback, RATE)
    poles = np.linalg.eigvals(designed.servo.A + tracking @ designed.servo_feedback)
    assert np.abs(poles).max() < 1 - 1e-4


def test_a_model_that_rejects_rest_is_refused_with_the_reason() -> None:
    """A zero at rest: no input makes a constant position, so no integral can."""
    stage = model("z")
    blocked = replace(stage, C=stage.C @ (np.eye(stage.order) - stage.A))
    with pytest.raises(ValueError, match="gain at rest"):
        linear_quadratic(blocked, servo(Outer(), 20.0, RATE), 1.0)


def test_a_model_of_two_outputs_is_refused() -> None:
    stage = model("z")
    two = InnovationModel(
        stage.A, stage.B, np.vstack([stage.C] * 2), np.zeros((2, 1)), np.zeros((stage.order, 2)), RATE, np.eye(2)
    )
    with pytest.raises(ValueError, match="1 inputs and 2 outputs"):
        linear_quadratic(two, servo(Outer(), 20.0, RATE), 1.0)


def test_a_resonance_beyond_half_the_rate_is_refused() -> None:
    with pytest.raises(ValueError, match="6000 Hz, must be > 0 and < 5000"):
        servo(Outer(resonances=(6_000.0,)), 20.0, RATE)
