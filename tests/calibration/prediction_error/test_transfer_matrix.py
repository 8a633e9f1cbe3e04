"""Transfer matrices: elements of unlike orders found under coloured noise, with errors that hold."""

import numpy as np
import pytest
from scipy.signal import lfilter

from calibration.fit_measures import fit
from calibration.prediction_error import identify_transfer_matrix

RATE = 250.0
ORDERS = [[2, 4, 2], [3, 6, 2], [2, 2, 5]]
GRID = np.exp(1j * np.linspace(0.02, 3.0, 400))

Quotient = tuple[np.ndarray, np.ndarray]


def element(order: int, rng: np.random.Generator) -> Quotient:
    """Return numerator and denominator of unit power: modes from 3 to 60 Hz, of an odd order a real pole as well."""
    poles: list[complex] = [rng.uniform(0.6, 0.95)] if order % 2 else []
    while len(poles) < order:
        speed, damping = 2 * np.pi * rng.uniform(3, 60), rng.uniform(0.03, 0.3)
        pole = np.exp(speed * (-damping + 1j * np.sqrt(1 - damping**2)) / RATE)
        poles += [pole, pole.conj()]
    denominator = np.poly(poles).real
    numerator = np.concatenate([[0.0], rng.standard_normal(order)])
    size = np.sqrt(np.mean(np.abs(np.polyval(numerator, GRID) / np.polyval(denominator, GRID)) ** 2))
    return numerator / size, denominator


def matrix(orders: list[list[int]], seed: int = 3) -> list[list[Quotient]]:
    """Return a transfer matrix."""
    rng = np.random.default_rng(seed)
    return [[element(order, rng) for order in row] for row in orders]


def measured(
    truth: list[list[Quotient]], samples: int, seed: int, noise: float = 0.1, direct: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Drive it with white noise; noise of a resonance of its own is on every output."""
    rng = np.random.default_rng(seed)
    u = rng.standard_normal((samples, len(truth[0])))
    columns = []
    for row in truth:
        y = sum((lfilter(*quotient, u[:, number]) for number, quotient in enumerate(row)), direct * u[:, 0])
        columns.append(y + lfilter([1.0], [1.0, -1.5, 0.8], noise * rng.standard_normal(samples)))
    return u, np.array(columns).T


def miss(found: Quotient, truth: Quotient) -> float:
    """Return the relative error of a frequency response."""
    one, other = (np.polyval(q[0], GRID) / np.polyval(q[1], GRID) for q in (found, truth))
    return float(np.linalg.norm(one - other) / np.linalg.norm(other))


@pytest.mark.slow
def test_a_matrix_of_orders_2_to_6_is_found_under_coloured_noise() -> None:
    truth = matrix(ORDERS)
    u, y = measured(truth, 10_000, seed=1)
    found = identify_transfer_matrix(u, y, RATE, ORDERS)
    quotients = [list(zip(*rows, strict=True)) for rows in zip(found.numerators, found.denominators, strict=True)]
    misses = [miss(quotients[i][j], truth[i][j]) for i in range(3) for j in range(3)]
    assert max(misses) < 0.03
    assert all(found.arrived)
    assert [[len(part) - 1 for part in row] for row in found.denominators] == ORDERS
    fresh = fit(found.model, *([part] for part in measured(truth, 5000, seed=2)))
    assert fresh.whiteness.outside < 0.05
    np.testing.assert_allclose(np.diag(found.model.innovation), 0.01, rtol=0.05)


@pytest.mark.slow
def test_the_state_space_is_the_quotients() -> None:
    u, y = measured(matrix([[2, 3]]), 2000, seed=3, direct=0.7)
    found = identify_transfer_matrix(u, y, RATE, [[2, 3]], direct=True)
    response = found.model.frequency_response(np.angle(GRID) * RATE / (2 * np.pi))
    for number in range(2):
        expected = np.polyval(found.numerators[0][number], GRID) / np.polyval(found.denominators[0][number], GRID)
        np.testing.assert_allclose(response[:, 0, number], expected, rtol=1e-8)
    np.testing.assert_allclose(found.model.D, [[0.7, 0.0]], atol=0.01)


@pytest.mark.slow
def test_standard_errors_cover() -> None:
    truth = matrix([[2, 4]], seed=5)
    pole = np.roots(truth[0][0][1])[0]
    frequency = abs(RATE * np.log(pole)) / (2 * np.pi)
    found = [
        identify_transfer_matrix(*measured(truth, 1500, seed=100 + seed), RATE, [[2, 4]]).errors[0][0]
        for seed in range(25)
    ]
    ratio = [(each.modes.frequency[0] - frequency) / each.frequency[0] for each in found if each is not None]
    assert len(ratio) == 25
    assert np.sqrt(np.mean(np.square(ratio))) == pytest.approx(1.0, abs=0.35)


def test_an_element_of_order_0_is_left_out_or_is_a_gain() -> None:
    truth = matrix([[2, 2]])
    u, y = measured(truth, 2000, seed=4)
    u = np.concatenate([u, np.random.default_rng(0).standard_normal((len(u), 1))], axis=1)
    plain = identify_transfer_matrix(u, y, RATE, [[2, 2, 0]])
    np.testing.assert_array_equal(plain.numerators[0][2], [0.0])
    assert plain.errors[0][2] is None
    gained = identify_transfer_matrix(u, y + 0.5 * u[:, [2]], RATE, [[2, 2, 0]], direct=True)
    assert gained.numerators[0][2][0] == pytest.approx(0.5, abs=0.02)


def test_noiseless_records_give_the_quotients_back() -> None:
    truth = matrix([[3]])
    found = identify_transfer_matrix(*measured(truth, 1000, seed=5, noise=0.0), RATE, 3)
    np.testing.assert_allclose(found.denominators[0][0], truth[0][0][1], atol=1e-6)
    np.testing.assert_allclose(found.numerators[0][0], truth[0][0][0], atol=1e-6)


def test_units_make_no_difference() -> None:
    u, y = measured(matrix([[2], [3]]), 2000, seed=6)
    plain = identify_transfer_matrix(u, y, RATE, [[2], [3]])
    scaled = identify_transfer_matrix(1e3 * u, 1e-6 * y, RATE, [[2], [3]])
    for row in range(2):
        np.testing.assert_allclose(1e9 * scaled.numerators[row][0], plain.numerators[row][0], rtol=1e-4, atol=1e-6)


def test_orders_that_do_not_fit_are_refused() -> None:
    u, y = measured(matrix([[2, 2]]), 500, seed=7)
    for orders in ([[2]], [[2, 2], [2, 2]]):
        with pytest.raises(ValueError, match="must be one number or 1 rows of 2"):
            identify_transfer_matrix(u, y, RATE, orders)
    with pytest.raises(ValueError, match="must be 0 to"):
        identify_transfer_matrix(u, y, RATE, -1)
    with pytest.raises(ValueError, match="an element of order >= 1"):
        identify_transfer_matrix(u, y, RATE, 0)
