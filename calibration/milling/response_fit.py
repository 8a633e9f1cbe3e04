"""A model of third order behind a delay, fitted to a measured frequency response by least squares."""

import numpy as np
from scipy.optimize import least_squares

from stagectl.robot.milling.axis_model import ORDER, AxisModel

LONGEST_DELAY = 10
"""Samples that are tried."""
ROUNDS = 20
"""In which the denominator found weighs the next fit."""

LARGEST, INSIDE = 1 - 1e-6, 0.995
"""Of a zero of the denominator: at most, and where a fit begins at most."""
NOTHING = 1e-15
"""A denominator that has come to zero by rounding, on the way to another."""


def fit_response(frequency: np.ndarray, response: np.ndarray, weight: np.ndarray, rate: float) -> AxisModel:
    """Return the stable model that is nearest, of all delays.

    Parameters
    ----------
    frequency : array, shape (bins,), Hz
    response : complex array, shape (bins,), 1
    weight : array, shape (bins,), 1
    rate : float, samples/s

    Source
    ------
    Sanathanan and Koerner, IEEE Trans. Automatic Control 8 (1963) 56, for the start; then Levenberg and Marquardt's
    method on the distance itself.
    """
    turn = np.exp(2j * np.pi * frequency / rate)
    best: tuple[float, AxisModel] | None = None
    for delay in range(LONGEST_DELAY + 1):
        wanted = response * turn**delay
        found = least_squares(_residual, _start(turn, wanted, weight), args=(turn, wanted, weight), method="lm")
        if best is None or found.cost < best[0]:
            best = float(found.cost), AxisModel(found.x[:ORDER], _denominator(found.x[ORDER:]), delay, rate)
    assert best is not None
    return best[1]


def _start(turn: np.ndarray, wanted: np.ndarray, weight: np.ndarray) -> np.ndarray:
    powers = turn[:, None] ** np.arange(ORDER - 1, -1, -1)
    columns = np.concatenate([powers, -wanted[:, None] * powers], axis=1)
    found, scale = np.zeros(2 * ORDER), weight / np.abs(turn**ORDER)
    for _ in range(ROUNDS):
        rows, target = scale[:, None] * columns, scale * wanted * turn**ORDER
        found = np.linalg.lstsq(_real(rows), _real(target), rcond=None)[0]
        scale = weight / np.abs(np.polyval(np.concatenate([[1.0], found[ORDER:]]), turn))
    return np.concatenate([found[:ORDER], _free(np.concatenate([[1.0], found[ORDER:]]))])


def _denominator(free: np.ndarray) -> np.ndarray:
    """Return a denominator, shape (4,), from three numbers that may be anything: its zeros stay in the unit circle."""
    alone, last, across = np.tanh(free) * LARGEST
    return np.convolve([1.0, -alone], [1.0, across * (1.0 + last), last])


def _free(denominator: np.ndarray) -> np.ndarray:
    """Return the three numbers of a denominator, shape (4,), with its zeros moved inside where they are not."""
    zeros = np.roots(denominator)
    size = np.abs(zeros)
    zeros = zeros * np.minimum(size, np.minimum(1.0 / size, INSIDE)) / size
    at = int(np.argmin(np.abs(zeros.imag)))  # three have a real one; the others are a pair, or real as well
    pair = np.real(np.poly(np.delete(zeros, at)))
    parts = np.array([zeros[at].real, pair[2], pair[1] / (1.0 + pair[2])])
    return np.asarray(np.arctanh(np.clip(parts / LARGEST, -INSIDE, INSIDE)))


def _residual(found: np.ndarray, turn: np.ndarray, wanted: np.ndarray, weight: np.ndarray) -> np.ndarray:
    below = np.polyval(_denominator(found[ORDER:]), turn)
    below[np.abs(below) < NOTHING] = NOTHING
    model = np.polyval(found[:ORDER], turn) / below
    return _real(weight * (model - wanted))


def _real(values: np.ndarray) -> np.ndarray:
    return np.concatenate([values.real, values.imag])
