"""The modal form: its response is that of its matrices, its slopes are those of differences."""

import numpy as np

from calibration.frequency_domain.modal_form import ModalForm

POINTS = 1j * np.linspace(0.1, 3.0, 7)


def form(pairs: int, single: int) -> ModalForm:
    rng = np.random.default_rng(5)
    n = 2 * pairs + single
    decay, turn = rng.uniform(0.05, 0.5, pairs + single), rng.uniform(0.3, 2.0, pairs)
    return ModalForm(decay, turn, *(rng.standard_normal(shape) for shape in ((n, 2), (3, n), (3, 2))))


def test_its_response_is_that_of_its_matrices() -> None:
    for each in (form(2, 1), form(0, 2), form(3, 0)):
        unit = np.eye(each.order)
        expected = [each.C @ np.linalg.solve(s * unit - each.A, each.B) + each.D for s in POINTS]
        np.testing.assert_allclose(each.response(POINTS), expected, rtol=1e-12)


def test_slopes_are_those_of_differences() -> None:
    for each in (form(2, 1), form(0, 2), form(3, 0)):
        _, by = each.slopes(POINTS)
        for at in range(len(each.numbers)):
            step = np.zeros(len(each.numbers))
            step[at] = 1e-6
            ahead, behind = (each.with_numbers(each.numbers + sign * step).response(POINTS) for sign in (1, -1))
            np.testing.assert_allclose(by[..., at], (ahead - behind) / 2e-6, atol=1e-7)


def test_numbers_go_there_and_back() -> None:
    each = form(2, 1)
    again = each.with_numbers(each.numbers)
    np.testing.assert_allclose(again.A, each.A)
    np.testing.assert_array_equal(again.C, each.C)
