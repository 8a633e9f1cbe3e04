"""Zeros outside the unit circle mirrored into it, so that what is inverted has a stable inverse."""

import math

import numpy as np
from numba import njit

MOST_ZEROS = 2


def minimum_phase(numerator: np.ndarray) -> np.ndarray:
    """Mirror the zeros of a polynomial that lie outside the unit circle: z to 1 / conj(z).

    The magnitude on the unit circle stays what it is, and so does the value at z = 1.

    Parameters
    ----------
    numerator : array, shape (coefficients,), any unit
        One to three, of falling powers of z; a leading zero is a zero at infinity, mirrored to the origin.

    Returns
    -------
    array, shape (coefficients,), the same unit

    Raises
    ------
    ValueError : another number of coefficients.

    Source
    ------
    Sörnmo 2015, section 3.2: the magnitude of the zero inverted, its argument unaltered.

    Examples
    --------
    >>> minimum_phase(np.array([1.0, -2.0]))
    array([-2.,  1.])
    """
    if not 1 <= len(numerator) <= MOST_ZEROS + 1:
        raise ValueError(f"there are {len(numerator)} coefficients, must be 1 to {MOST_ZEROS + 1}")
    mirrored = np.array(numerator, dtype=np.float64)
    mirror(mirrored, 0, len(mirrored))
    return mirrored


@njit(cache=True, nogil=True)
def mirror(values, first, count):  # type: ignore[no-untyped-def]
    """Mirror the zeros of the polynomial in `values[first : first + count]`, of one to three coefficients, in place."""
    if count == 2:
        if abs(values[first + 1]) > abs(values[first]):
            values[first], values[first + 1] = values[first + 1], values[first]
    elif count == 3:
        _mirror_two(values, first)


@njit(cache=True, nogil=True)
def _mirror_two(values, first):  # type: ignore[no-untyped-def]
    """Mirror up to two zeros; (a z - q)(z - c / q) is the polynomial, with the larger zero in the first factor."""
    a, b, c = values[first], values[first + 1], values[first + 2]
    inside = b * b - 4.0 * a * c
    if inside <= 0.0:  # a pair, whose product is c / a
        if abs(c) > abs(a):
            values[first], values[first + 2] = c, a
        return
    q = -0.5 * (b + math.copysign(math.sqrt(inside), b))
    if abs(q) <= abs(a):
        return
    small, lead = c / q, -q
    if abs(small) > 1.0:
        values[first], values[first + 1], values[first + 2] = c, b, a
        return
    values[first], values[first + 1], values[first + 2] = lead, a - lead * small, -a * small
