"""B, D, offset and first states by the error one step ahead, with A, C and K held."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.linalg import solve_triangular

from calibration.subspace.kalman_gain import Gain, whitening
from calibration.subspace.modal import Modal
from calibration.subspace.modal_regression import regress, responses, sums
from calibration.subspace.regression import Regression, Terms

ROUNDING = 1e-13
"""Of a level of which no offset is told."""


def regress_ahead(
    predictor: Modal,
    outlet: np.ndarray,
    gain: Gain,
    drives: Sequence[np.ndarray],
    measured: Sequence[np.ndarray],
    terms: Terms,
) -> tuple[Regression, list[np.ndarray]]:
    """Fit what a predictor makes of the inputs to what it leaves of the outputs, weighted by the innovations.

    Parameters
    ----------
    predictor : Modal
        A - K C.
    outlet : array, shape (p, n), 1
    gain : Gain
    drives : sequence of arrays, each of shape (N, m), 1
    measured : sequence of arrays, each of shape (N, p), 1
    terms : Terms

    Returns
    -------
    regression : Regression
        Of the predictor: its inlet is B - K D, its constant the level that all outputs, fed back, are short of.
    known : list of arrays, each of shape (N, p), 1
        What the predictor makes of the outputs alone.
    """
    root, rest = whitening(gain.innovation), np.zeros(len(gain.matrix))
    known = [responses(predictor, outlet, gain.matrix, each, rest) for each in measured]
    records = [
        sums(predictor, drive, solve_triangular(root, (response - told).T, lower=True).T)
        for drive, response, told in zip(drives, measured, known, strict=True)
    ]
    found = regress(predictor, solve_triangular(root, outlet, lower=True), records, terms)
    return replace(found, direct=root @ found.direct, constant=root @ found.constant), known


def offset(transition: np.ndarray, outlet: np.ndarray, gain: Gain, level: np.ndarray) -> np.ndarray:
    """Return the offset of the outputs, shape (p,), that a predictor which is fed all of them shows as a level.

    What integrates, or nearly, needs a very large one, for other inputs than their mean: see `rest_near`.

    Parameters
    ----------
    transition : array, shape (n, n), 1
    outlet : array, shape (p, n), 1
    gain : Gain
    level : array, shape (p,), 1
    """
    settled = np.linalg.solve(np.eye(len(transition)) - transition + gain.matrix @ outlet, gain.matrix)
    found: np.ndarray = np.linalg.lstsq(np.eye(len(outlet)) - outlet @ settled, level, rcond=ROUNDING)[0]
    return found
