"""Derivatives, against differences: of the response by every free parameter, for every kind of pole."""

import numpy as np
import pytest

from calibration.prediction_error.element import Element, balanced, every_step, pole_slopes
from calibration.prediction_error.local_coordinates import Coordinates, around, free, gain_only
from calibration.prediction_error.normal_equations import Record, normal_equations, residual
from calibration.prediction_error.parallel_form import decomposed, joined

STEP = 1e-5
POLES = {
    "complex": [0.8 + 0.5j, 0.9 + 0.1j],
    "real": [0.95, 0.5, -0.3],
    "mixed": [0.7 + 0.6j, 0.97, 0.9, 0.2],
    "nearly equal": [0.9, 0.9 - 1e-4, 0.3 + 0.4j],
}


def system(poles: list[complex], seed: int, inputs: int = 3, outputs: int = 2) -> Element:
    """Return an element with these poles (and their conjugates) in states without any order."""
    rng = np.random.default_rng(seed)
    full = [q for p in poles for q in ([p, p.conjugate()] if isinstance(p, complex) else [p])]
    polynomial = np.poly(full).real
    a = np.eye(len(full), k=-1)
    a[0] = -polynomial[1:]
    turn = np.linalg.qr(rng.standard_normal(a.shape))[0]
    a = turn.T @ a @ turn
    return Element(a, rng.standard_normal((len(a), inputs)), rng.standard_normal((outputs, len(a))))


def response(at: Coordinates, step: np.ndarray, record: Record, state: np.ndarray) -> np.ndarray:
    """Return what the elements give after a step, from their own states: shape (N, outputs)."""
    elements, direct = at.moved(step)
    rest = np.zeros_like(state)
    start = at.states_moved(state, rest, np.zeros_like(step))
    taken = [decomposed(e.a, e.b, e.c, e.first) for e in elements]
    form = joined([form for form, _ in taken], direct)
    sections = [np.linalg.solve(basis, part) for (_, basis), part in zip(taken, start, strict=True)]
    return record.target - residual(form, record, np.concatenate(sections))


@pytest.mark.parametrize("kind", POLES)
def test_normal_equations_agree_with_differences(kind: str) -> None:
    element = system(POLES[kind], seed=4)
    rng = np.random.default_rng(1)
    record = Record(rng.standard_normal((300, 3)), rng.standard_normal((300, 2)))
    start = [rng.standard_normal(len(element.a))]
    at, states = around([element], rng.standard_normal((2, 2)), [start], free)
    weight = np.array([[1.0, 0.0], [0.4, 2.0]])
    normal = normal_equations(at.form, at.slopes, [record], states, weight)
    count = at.slopes.shape[1]
    assert count == len(element.a) * (3 + 2) + 4
    moves = np.eye(count) * STEP
    slopes = [response(at, m, record, states[0]) - response(at, -m, record, states[0]) for m in moves]
    jacobian = (np.array(slopes) / (2 * STEP)) @ weight.T
    by_state = jacobian_by_state(at, record, states[0]) @ weight.T
    flat, flat_state = jacobian.reshape(count, -1), by_state.reshape(len(by_state), -1)
    misfit = (residual(at.form, record, states[0]) @ weight.T).ravel()
    across = np.linalg.pinv(flat_state @ flat_state.T)
    cleared = flat - (flat @ flat_state.T) @ across @ flat_state
    np.testing.assert_allclose(
        normal.information, cleared @ cleared.T, rtol=1e-6, atol=1e-6 * np.abs(normal.information).max()
    )
    np.testing.assert_allclose(normal.slope, cleared @ misfit, rtol=1e-6, atol=1e-6 * np.abs(normal.slope).max())


def jacobian_by_state(at: Coordinates, record: Record, state: np.ndarray) -> np.ndarray:
    """Return the response's derivatives by the sections' initial state, in which it is linear: (n, N, outputs)."""
    plain = residual(at.form, record, state)
    return np.array([plain - residual(at.form, record, state + move) for move in np.eye(len(state))])


def test_a_gain_steps_alone() -> None:
    element = system(POLES["complex"], seed=2, inputs=2)
    rng = np.random.default_rng(5)
    gain = 0.05 * rng.standard_normal((len(element.a), 2))
    predictor = Element(element.a - gain @ element.c, gain, element.c)
    at, _ = around([predictor], np.zeros((2, 0)), [[np.zeros(len(gain))]], gain_only)
    (moved,), _ = at.moved(rng.standard_normal(gain.size))
    assert not np.allclose(moved.b, gain)
    np.testing.assert_allclose(moved.a + moved.b @ moved.c, element.a, atol=1e-12)
    np.testing.assert_array_equal(moved.c, element.c)


def test_no_free_step_is_a_mere_change_of_basis() -> None:
    """Markov parameters move, to first order, by independent amounts."""
    element, _ = balanced(system(POLES["mixed"], seed=3))
    steps = every_step(element)

    def markov(amounts: np.ndarray) -> np.ndarray:
        moved = element.moved(steps, amounts)
        powers = [np.linalg.matrix_power(moved.a, k) for k in range(25)]
        return np.concatenate([(moved.c @ power @ moved.b).ravel() for power in powers])

    moves = np.eye(len(steps.a)) * STEP
    slopes = np.array([markov(move) - markov(-move) for move in moves]) / (2 * STEP)
    sizes = np.linalg.svd(slopes, compute_uv=False)
    assert sizes[-1] > 1e-6 * sizes[0]  # a change of basis would be 1e-10


def test_balanced_states_change_nothing_outside() -> None:
    element = system(POLES["mixed"], seed=6)
    found, basis = balanced(element)
    for power in range(5):
        expected = element.c @ np.linalg.matrix_power(element.a, power) @ element.b
        np.testing.assert_allclose(found.c @ np.linalg.matrix_power(found.a, power) @ found.b, expected, rtol=1e-8)
    np.testing.assert_allclose(basis @ found.a, element.a @ basis, atol=1e-8 * np.abs(basis).max())


def test_states_too_far_from_normal_to_be_balanced_are_scaled_alone() -> None:
    """Poles of 0.98, and rounding that makes powers of the matrix grow without end."""
    random = np.random.default_rng(1)
    a = 0.98 * np.eye(80) + 1e3 * np.triu(random.standard_normal((80, 80)), 1)
    element = Element(a, random.standard_normal((80, 2)), random.standard_normal((2, 80)))
    found, basis = balanced(element)
    np.testing.assert_allclose(basis @ found.a, a @ basis, rtol=1e-12, atol=1e-12 * np.abs(a @ basis).max())


def test_poles_move_as_their_slopes_say() -> None:
    element = system(POLES["mixed"], seed=7)
    directions = np.random.default_rng(0).standard_normal((3, *element.a.shape))
    poles, slopes = pole_slopes(element.a, directions)
    for number, direction in enumerate(directions):
        for pole, slope in zip(poles, slopes[:, number], strict=True):
            moved = np.linalg.eigvals(element.a + 1e-8 * direction)
            assert moved[np.argmin(np.abs(moved - pole))] - pole == pytest.approx(1e-8 * slope, rel=1e-3, abs=1e-12)


def test_equal_poles_are_taken_apart_all_the_same() -> None:
    jordan = np.array([[0.8, 1.0, 0.0], [0.0, 0.8, 1.0], [0.0, 0.0, 0.8]])
    form, _ = decomposed(jordan, np.ones((3, 1)), np.array([[1.0, 0.0, 0.0]]))
    record = Record(np.eye(60, 1), np.zeros((60, 1)))
    expected = [0.0] + [(np.linalg.matrix_power(jordan, k) @ np.ones(3))[0] for k in range(59)]
    found = -residual(joined([form], np.zeros((1, 0))), record, np.zeros(3))
    np.testing.assert_allclose(found[:, 0], expected, atol=1e-4 * max(expected))
