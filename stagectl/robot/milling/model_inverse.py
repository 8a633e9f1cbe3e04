"""L, an inverse of G_R: with its zeros mirrored into the unit circle, or regularised."""

import numpy as np

from stagectl.robot.midranging.minimum_phase import minimum_phase
from stagectl.robot.milling.axis_model import AxisModel
from stagectl.robot.pocket_config import Inverse


def mirrored_inverse(axis: AxisModel, frequency: np.ndarray) -> np.ndarray:
    """Return the inverse of a model whose zeros outside the unit circle are mirrored into it, and its delay undone.

    It is the inverse's magnitude everywhere; its phase is off by twice the phase of each zero that was mirrored.

    Parameters
    ----------
    axis : AxisModel
    frequency : array, shape (bins,), Hz

    Returns
    -------
    complex array, shape (bins,), 1

    Source
    ------
    Sörnmo 2015, sec. 5.2 and fig. 3.4.
    """
    return 1.0 / AxisModel(minimum_phase(axis.numerator), axis.denominator, axis.delay, axis.rate).response(frequency)


def regularised_inverse(response: np.ndarray, floor: float) -> np.ndarray:
    """Return conj(G) / (|G|^2 + floor): without phase error, and at most 1 / (2 sqrt(floor)) where G is small.

    Parameters
    ----------
    response : complex array, shape (bins,), 1
    floor : float, 1, >= 0

    Returns
    -------
    complex array, shape (bins,), 1

    Source
    ------
    Tikhonov, as (6.19) of Sörnmo 2015; the trial is filtered as a whole, so it need not be causal.

    Examples
    --------
    >>> regularised_inverse(np.array([1.0 + 0j, 0.0 + 0j]), 0.0625)
    array([0.94117647-0.j, 0.        -0.j])
    """
    found: np.ndarray = response.conj() / (np.abs(response) ** 2 + floor)
    return found


def inverse(axis: AxisModel, frequency: np.ndarray, kind: Inverse, epsilon: float) -> np.ndarray:
    """Return L of one direction, complex, shape (bins,), 1.

    Parameters
    ----------
    axis : AxisModel
    frequency : array, shape (bins,), Hz
    kind : "regularised" or "mirrored"
    epsilon : float, 1
        Of the regularised one: its floor over the square of the gain at rest.
    """
    if kind == "mirrored":
        return mirrored_inverse(axis, frequency)
    at_rest = float(abs(axis.response(np.zeros(1))[0]))
    return regularised_inverse(axis.response(frequency), epsilon * at_rest**2)
