"""The innovation-form state space: its recursions, its modes, its checks."""

from dataclasses import replace

import numpy as np
import pytest

from calibration.state_space.model import InnovationModel

RATE = 1000.0


def resonant(order: int = 4, inputs: int = 2, outputs: int = 3, seed: int = 1) -> InnovationModel:
    """Return a stable model with resonances, a predictor that is stable as well, and a direct term."""
    rng = np.random.default_rng(seed)
    angle = rng.uniform(0.1, 1.0, order // 2)
    poles = 0.95 * np.exp(1j * angle)
    matrix = np.zeros((order, order))
    for mode, pole in enumerate(poles):
        both = slice(2 * mode, 2 * mode + 2)
        matrix[both, both] = [[pole.real, pole.imag], [-pole.imag, pole.real]]
    turn = np.linalg.qr(rng.standard_normal((order, order)))[0]
    outlet = rng.standard_normal((outputs, order))
    return InnovationModel(
        turn @ matrix @ turn.T,
        rng.standard_normal((order, inputs)),
        outlet,
        rng.standard_normal((outputs, inputs)),
        0.05 * turn @ matrix @ turn.T @ np.linalg.pinv(outlet),
        RATE,
        np.diag(rng.uniform(0.5, 1.0, outputs)),
    )


def test_a_free_run_is_the_recursion_written_out() -> None:
    model, rng = resonant(), np.random.default_rng(2)
    drive, start = rng.standard_normal((50, 2)), rng.standard_normal(4)
    state, expected = start, []
    for sample in drive:
        expected.append(model.C @ state + model.D @ sample)
        state = model.A @ state + model.B @ sample
    np.testing.assert_allclose(model.simulate(drive, start), expected, rtol=1e-12)


def test_a_free_run_leaves_drive_and_state_as_they_were() -> None:
    model, drive, state = resonant(), np.ones((5, 2)), np.ones(4)
    model.simulate(drive, state)
    assert np.all(drive == 1)
    assert np.all(state == 1)


def test_the_prediction_misses_exactly_the_innovations_the_record_was_made_with() -> None:
    model, rng = resonant(), np.random.default_rng(3)
    drive, innovations, state = rng.standard_normal((200, 2)), rng.standard_normal((200, 3)), np.zeros(4)
    response = np.empty((200, 3))
    for n in range(200):
        response[n] = model.C @ state + model.D @ drive[n] + innovations[n]
        state = model.A @ state + model.B @ drive[n] + model.K @ innovations[n]
    np.testing.assert_allclose(response - model.predict(drive, response), innovations, atol=1e-12)


def test_a_prediction_without_gain_is_the_free_run() -> None:
    model = replace(resonant(), K=np.zeros((4, 3)))
    rng = np.random.default_rng(4)
    drive, response = rng.standard_normal((60, 2)), rng.standard_normal((60, 3))
    np.testing.assert_allclose(model.predict(drive, response), model.simulate(drive), rtol=1e-12, atol=1e-13)


def test_the_state_a_record_began_with_is_found() -> None:
    model, rng = resonant(), np.random.default_rng(5)
    drive, state = rng.standard_normal((9000, 2)), rng.standard_normal(4)
    response = model.simulate(drive, state)
    np.testing.assert_allclose(model.initial_state(drive, response), state, rtol=1e-9)
    np.testing.assert_allclose(model.initial_predictor_state(drive, response), state, rtol=1e-9)


def test_the_initial_state_is_the_least_squares_one_in_units_of_the_innovations() -> None:
    model, rng = resonant(), np.random.default_rng(6)
    drive, response = rng.standard_normal((300, 2)), rng.standard_normal((300, 3))
    size = np.sqrt(np.diag(model.innovation))
    free = np.stack([(model.simulate(np.zeros((300, 2)), unit) / size).ravel() for unit in np.eye(4)], axis=1)
    wanted = np.linalg.lstsq(free, ((response - model.simulate(drive)) / size).ravel())[0]
    np.testing.assert_allclose(model.initial_state(drive, response), wanted, rtol=1e-7)


def test_the_initial_state_of_a_slow_system_rests_on_the_whole_record() -> None:
    model = InnovationModel([[0.9999]], [[1.0]], [[1.0]], [[0.0]], [[0.0]], RATE, [[1.0]])
    response = np.random.default_rng(7).standard_normal((12_000, 1))
    free = 0.9999 ** np.arange(12_000)
    wanted = free @ response / (free @ free)
    np.testing.assert_allclose(model.initial_state(np.zeros((12_000, 1)), response), wanted, rtol=1e-9)


def test_a_state_that_no_output_sees_is_left_at_zero() -> None:
    model = InnovationModel(np.diag([0.9, 0.5]), np.ones((2, 1)), [[1.0, 0.0]], [[0.0]], [[0.0], [0.0]], RATE, [[1.0]])
    response = model.simulate(np.zeros((40, 1)), np.array([2.0, 3.0]))
    np.testing.assert_allclose(model.initial_state(np.zeros((40, 1)), response), [2.0, 0.0], atol=1e-12)


def test_an_unstable_models_state_is_zero_when_its_free_response_overflows() -> None:
    model = InnovationModel([[3.0]], [[0.0]], [[1.0]], [[0.0]], [[0.0]], RATE, [[1.0]])
    assert model.initial_state(np.zeros((5000, 1)), np.ones((5000, 1))) == 0.0
    assert not model.is_stable


def test_the_frequency_response_is_that_of_a_long_free_run() -> None:
    model = resonant()
    pulse = np.zeros((4000, 2))
    pulse[0, 1] = 1.0
    bins = np.array([0, 50, 400, 1999])
    expected = np.fft.rfft(model.simulate(pulse), axis=0)[bins]
    found = model.frequency_response(bins * RATE / 4000)
    assert found.shape == (4, 3, 2)
    np.testing.assert_allclose(found[:, :, 1], expected, rtol=1e-9)


def test_a_static_gain_is_a_model_of_order_zero() -> None:
    empty = np.zeros((0, 1))
    model = InnovationModel(np.zeros((0, 0)), empty, np.zeros((1, 0)), [[2.0]], empty, RATE, [[1.0]])
    assert np.all(model.simulate(np.ones((3, 1))) == 2.0)
    assert np.all(model.frequency_response(np.array([10.0])) == 2.0)
    assert model.initial_state(np.ones((3, 1)), np.ones((3, 1))).shape == (0,)


def test_modes_come_by_rising_frequency_with_their_damping() -> None:
    angle = 2 * np.pi * np.array([95.0, 62.0]) / RATE
    damping = np.array([0.015, 0.01])
    pairs = np.exp(angle * (-damping + 1j * np.sqrt(1 - damping**2)))
    slow = np.exp(-2 * np.pi * 12.0 / RATE)
    blocks = np.zeros((6, 6))
    for mode, pole in enumerate(pairs):
        both = slice(2 * mode, 2 * mode + 2)
        blocks[both, both] = [[pole.real, pole.imag], [-pole.imag, pole.real]]
    blocks[4, 4], blocks[5, 5] = slow, 0.0
    model = InnovationModel(blocks, np.ones((6, 1)), np.ones((1, 6)), [[0.0]], np.zeros((6, 1)), RATE, [[1.0]])
    found = model.modes
    np.testing.assert_allclose(found.frequency, [12.0, 62.0, 95.0, np.inf], rtol=1e-9)
    np.testing.assert_allclose(found.damping, [1.0, 0.01, 0.015, 1.0], rtol=1e-9)
    assert np.all(found.pole.imag >= 0)


def test_an_integrator_has_neither_frequency_nor_damping() -> None:
    model = InnovationModel([[1.0]], [[1.0]], [[1.0]], [[0.0]], [[0.0]], RATE, [[1.0]])
    assert model.modes.frequency == 0.0
    assert model.modes.damping == 0.0


def test_a_model_cannot_be_written_to_and_does_not_follow_the_arrays_it_was_made_of() -> None:
    matrix = np.array([[0.5]])
    model = InnovationModel(matrix, [[1.0]], [[1.0]], [[0.0]], [[0.0]], RATE, [[1.0]])
    matrix[0, 0] = 9.0
    assert model.A[0, 0] == 0.5
    with pytest.raises(ValueError, match="read-only"):
        model.A[0, 0] = 1.0


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"A": np.eye(3)}, r"A has shape \(3, 3\), must be \(4, 4\)"),
        ({"K": np.zeros((3, 4))}, r"K has shape \(3, 4\), must be \(4, 3\)"),
        ({"B": np.zeros(4)}, r"B has shape \(4,\) and C"),
        (
            {"C": np.zeros((0, 4)), "D": np.zeros((0, 2)), "K": np.zeros((4, 0)), "innovation": np.zeros((0, 0))},
            "the model has 0 outputs",
        ),
        ({"D": np.full((3, 2), np.nan)}, "D is not finite at row 0, column 0"),
        ({"innovation": np.triu(np.ones((3, 3)))}, "innovation is not symmetric"),
        ({"innovation": -np.eye(3)}, "innovation has the eigenvalue -1"),
        ({"rate": 0.0}, "rate is 0.0, must be > 0 samples/s"),
        ({"rate": float("nan")}, "rate is nan"),
        ({"input_names": ("a", "a")}, r"input_names is \('a', 'a'\), must be 2 different names"),
        ({"output_units": ("m",)}, r"output_units is \('m',\), must be 3 units"),
    ],
)
def test_what_is_no_model_is_refused_by_name_and_value(change: dict[str, object], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        replace(resonant(), **change)  # type: ignore[arg-type]  # what is wrong is the point


def test_signals_of_another_width_or_length_are_refused() -> None:
    model = resonant()
    with pytest.raises(ValueError, match=r"drive has shape \(2, 5\), must be \(N, 2\)"):
        model.simulate(np.zeros((2, 5)))
    with pytest.raises(ValueError, match="drive has 4 samples and response 5"):
        model.predict(np.zeros((4, 2)), np.zeros((5, 3)))
    with pytest.raises(ValueError, match=r"state has shape \(3,\), must be \(4,\)"):
        model.simulate(np.zeros((4, 2)), np.zeros(3))
