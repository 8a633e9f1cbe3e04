"""Standard errors of a frequency response, in magnitude and phase."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class ResponseErrors:
    """Standard errors, frequency by frequency.

    Parameters
    ----------
    magnitude : array, shape (bins, p, m), the outputs' per the inputs' units
    phase : array, shape (bins, p, m), rad
    """

    magnitude: np.ndarray
    phase: np.ndarray


def along_and_across(response: np.ndarray, moved: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return how magnitude and phase (rad) move with a response, both shapes of `moved`.

    Parameters
    ----------
    response : array, shape (p, m), complex, the outputs' per the inputs' units
    moved : array, shape (..., p, m), complex, the same units
        Small changes of it.
    """
    size = np.maximum(np.abs(response), np.finfo(float).tiny)
    turned = moved * response.conj() / size
    return turned.real, turned.imag / size
