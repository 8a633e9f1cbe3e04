"""Zeros outside the unit circle mirrored into it, so that what is inverted has a stable inverse."""

import numpy as np

from stagectl.robot.midranging.minimum_phase_kernel import mirror

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
    mirror(mirrored, len(mirrored))
    return mirrored
