"""B, D, offset and first states by the error one step ahead, with A, C and K held."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.linalg import solve_triangular

from calibration.subspace.kalman_gain import Gain, whitening
from calibration.subspace.modal import Modal
from calibration.subspace.modal_regression import regress, responses, sums
from calibration.subspace.regression import Regression, Terms


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


def offset(transition: np.ndarray, outlet: np.ndarray, gain: Gain, level: np.ndarray, samples: int) -> np.ndarray:
    """Return the offset of the outputs, shape (p,), that a predictor which is fed all of them shows as a level.

    Of an integrator any offset gives the level zero.  So the offset is weighed against one of 0 +- 1, the outputs' own
    spread, by what the records tell of the level.

    Parameters
    ----------
    transition : array, shape (n, n), 1
    outlet : array, shape (p, n), 1
    gain : Gain
    level : array, shape (p,), 1
    samples : int
        That it was fitted to.
    """
    settled = np.linalg.solve(np.eye(len(transition)) - transition + gain.matrix @ outlet, gain.matrix)
    shown = np.eye(len(outlet)) - outlet @ settled
    sure = whitening(gain.innovation / samples)
    rows = np.concatenate([solve_triangular(sure, shown, lower=True), np.eye(len(outlet))])
    told = np.concatenate([solve_triangular(sure, level, lower=True), np.zeros(len(outlet))])
    found: np.ndarray = np.linalg.lstsq(rows, told, rcond=None)[0]
    return found
