"""Levenberg-Marquardt on the weighted difference between a system's response and a measured one."""

from dataclasses import dataclass

import numpy as np

from calibration.frequency_domain.modal_form import ModalForm

STEPS = 100
SETTLED, TIMES = 1e-7, 3
"""Part of the cost by which a step must lower it, and how often in a row it may not, before the search ends."""
FIRST, LOWER, HIGHER, MOST = 1e-3, 0.3, 4.0, 1e10
"""Damping: at first, after a step that helped, after one that did not, and where it gives up."""

ROOM = 1_000_000
"""Slopes that are held at once."""


@dataclass(frozen=True, eq=False)
class Refined:
    """A system that fits, and how well.

    Parameters
    ----------
    form : ModalForm
    cost : float, 1
        Sum of |difference|^2 over variance.
    normal : array, shape (count, count), 1
        J^T J at the end, by the numbers of the form.
    """

    form: ModalForm
    cost: float
    normal: np.ndarray


def refine(
    form: ModalForm,
    points: np.ndarray,
    response: np.ndarray,
    sigma: np.ndarray,
    is_direct: bool,
    steps: int = STEPS,
) -> Refined:
    """Move all numbers of a system until its response fits best; poles stay stable.

    Parameters
    ----------
    form : ModalForm
        To start from.
    points : complex array, shape (K,), 1
        Values of s.
    response, sigma : arrays, shape (K, p, m), 1
        What was measured, and its standard errors: root of E |error|^2.
    is_direct : bool
        Whether D is fitted.
    steps : int, optional

    Source
    ------
    Marquardt 1963, "An algorithm for least-squares estimation of nonlinear parameters", J. SIAM 11, 431-441.
    """
    damping, idle = FIRST, 0
    cost, gradient, normal = _linear(form, points, response, sigma, is_direct)
    for _ in range(steps):
        scale = np.diag(normal) + np.finfo(float).eps * np.trace(normal)
        step = np.linalg.solve(normal + damping * np.diag(scale), gradient)
        with np.errstate(over="ignore", invalid="ignore"):  # of a step that goes too far
            trial = form.with_numbers(form.numbers + step)
            left = cost_of(trial, points, response, sigma)
        if not left < cost:
            damping *= HIGHER
            if damping > MOST:
                break
            continue
        idle = idle + 1 if cost - left < SETTLED * cost else 0
        form, damping = trial, damping * LOWER
        cost, gradient, normal = _linear(form, points, response, sigma, is_direct)
        if idle >= TIMES:
            break
    return Refined(form, cost, normal)


def cost_of(form: ModalForm, points: np.ndarray, response: np.ndarray, sigma: np.ndarray) -> float:
    """Return the sum of |difference|^2 over variance that a system leaves.

    Parameters
    ----------
    form : ModalForm
    points : complex array, shape (K,), 1
    response, sigma : arrays, shape (K, p, m), 1
    """
    return float(np.sum(np.abs((response - form.response(points)) / sigma) ** 2))


def _linear(
    form: ModalForm, points: np.ndarray, response: np.ndarray, sigma: np.ndarray, is_direct: bool
) -> tuple[float, np.ndarray, np.ndarray]:
    """Return cost, J^T r and J^T J."""
    count = len(form.numbers)
    at_once = max(1, ROOM // (response[0].size * count))
    cost, gradient, normal = 0.0, np.zeros(count), np.zeros((count, count))
    for first in range(0, len(points), at_once):
        part = slice(first, first + at_once)
        found, by = form.slopes(points[part], is_direct)
        missed = ((response[part] - found) / sigma[part]).ravel()
        slope = (by / sigma[part][..., np.newaxis]).reshape(len(missed), -1)
        normal += slope.real.T @ slope.real + slope.imag.T @ slope.imag
        gradient += slope.real.T @ missed.real + slope.imag.T @ missed.imag
        cost += float(np.sum(np.abs(missed) ** 2))
    return cost, gradient, normal
