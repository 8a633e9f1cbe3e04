"""The compiled mirror of zeros outside the unit circle, of polynomials with one to three coefficients."""

import math

import numpy as np

from rigkit.compiled import njit


@njit(cache=True, nogil=True)
def mirror(values: np.ndarray, count: int) -> None:
    """Mirror the zeros of the polynomial in `values[:count]`, of one to three coefficients, in place."""
    if count == 2:
        if abs(values[1]) > abs(values[0]):
            values[0], values[1] = values[1], values[0]
    elif count == 3:
        _mirror_two(values)


@njit(cache=True, nogil=True)
def _mirror_two(values: np.ndarray) -> None:
    """Mirror up to two zeros; (a z - q)(z - c / q) is the polynomial, with the larger zero in the first factor."""
    a, b, c = values[0], values[1], values[2]
    inside = b * b - 4.0 * a * c
    if inside <= 0.0:  # a pair, whose product is c / a
        if abs(c) > abs(a):
            values[0], values[2] = c, a
        return
    q = -0.5 * (b + math.copysign(math.sqrt(inside), b))
    if abs(q) <= abs(a):
        return
    small, lead = c / q, -q
    if abs(small) > 1.0:
        values[0], values[1], values[2] = c, b, a
        return
    values[0], values[1], values[2] = lead, a - lead * small, -a * small
