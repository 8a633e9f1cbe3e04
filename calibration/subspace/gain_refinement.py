"""The Kalman gain that predicts the records best: Gauss-Newton steps on the one-step-ahead error, all else held."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import solve_triangular

from calibration.subspace.forgetting import forgetting, slowest
from calibration.subspace.kalman_gain import Gain, is_stable, whitening
from calibration.subspace.modal import Modal, modal
from calibration.subspace.modal_regression import regress, responses, sums
from calibration.subspace.regression import Terms

_HALVINGS = 5
_ENOUGH = 20_000
"""Samples on which all steps but the last are taken: what so many leave uncertain the last one corrects."""


@dataclass(frozen=True)
class Effort:
    """When a search ends.

    Parameters
    ----------
    steps : int
    settled : float, 1
        Change of the log determinant of the innovations' covariance.
    """

    steps: int
    settled: float


FULL, QUICK = Effort(15, 1e-5), Effort(4, 3e-3)


def refine_gain(
    transition: np.ndarray, outlet: np.ndarray, gain: Gain, missed: Sequence[np.ndarray], effort: Effort = FULL
) -> Gain:
    """Lower the determinant of the one-step-ahead errors' covariance by the choice of K.

    The Riccati equation's gain knows no more of the noise than past horizons reach, and little where inputs excite few
    frequencies; this one knows all of the record.  Where no gain at all predicts better than that one, both are starts.
    The predictor stays stable, and no step is taken that does not help.

    Parameters
    ----------
    transition : array, shape (n, n), 1
        A.
    outlet : array, shape (p, n), 1
        C.
    gain : Gain
        To start from.
    missed : sequence of arrays, each of shape (N, p), 1
        What the free run leaves of each record.
    effort : Effort

    Source
    ------
    Ljung 1999, System Identification, 2nd ed., section 10.2 (Gauss-Newton on prediction errors).
    """
    samples = sum(len(each) for each in missed)
    stretch = [each[: max(len(outlet), len(each) * _ENOUGH // samples)] for each in missed]
    early = missed if samples <= 2 * _ENOUGH else stretch
    nothing = np.zeros_like(gain.matrix)
    doubtful = _loss(transition, outlet, nothing, early) < _loss(transition, outlet, gain.matrix, early)
    starts = [gain.matrix, nothing] if doubtful else [gain.matrix]
    ends = [_descend(transition, outlet, start, early, effort) for start in starts]
    matrix, innovation, _ = min(ends, key=lambda each: each[2])
    if early is stretch:
        matrix, innovation, _ = _descend(transition, outlet, matrix, missed, replace(effort, steps=1))
    radius = slowest(max(len(each) for each in missed))
    if not is_stable(transition - matrix @ outlet, radius):
        matrix = forgetting(transition, outlet, matrix, innovation, radius)
        matrix, innovation, _ = _descend(transition, outlet, matrix, missed, effort, radius)
    return Gain(matrix, innovation, gain.by_riccati)


def _loss(transition: np.ndarray, outlet: np.ndarray, gain: np.ndarray, missed: Sequence[np.ndarray]) -> float:
    """Return the log determinant of the innovations' covariance."""
    return _errors(modal(transition - gain @ outlet), outlet, gain, missed)[2]


def _descend(
    transition: np.ndarray,
    outlet: np.ndarray,
    gain: np.ndarray,
    missed: Sequence[np.ndarray],
    effort: Effort,
    radius: float = 1.0,
) -> tuple[np.ndarray, np.ndarray, float]:
    """Take Gauss-Newton steps, each shortened until it helps; return gain, innovations' covariance and loss."""
    modes = modal(transition - gain @ outlet)
    errors, covariance, loss = _errors(modes, outlet, gain, missed)
    for _ in range(effort.steps):
        if not np.isfinite(loss):
            break
        root = whitening(covariance)
        seen = solve_triangular(root, outlet, lower=True)
        records = [sums(modes, error, solve_triangular(root, error.T, lower=True).T) for error in errors]
        step = regress(modes, seen, records, Terms(direct=False, constant=False)).inlet
        before = loss
        for _ in range(_HALVINGS):
            trial = gain + step
            if is_stable(transition - trial @ outlet, radius):
                near = modal(transition - trial @ outlet)
                outcome = _errors(near, outlet, trial, missed)
                if outcome[2] < loss:
                    gain, modes, (errors, covariance, loss) = trial, near, outcome
                    break
            step = step / 2
        if not before - loss > effort.settled:
            break
    return gain, covariance, loss


def _errors(
    modes: Modal, outlet: np.ndarray, gain: np.ndarray, missed: Sequence[np.ndarray]
) -> tuple[list[np.ndarray], np.ndarray, float]:
    """Return the one-step-ahead errors, their covariance and its log determinant (infinite if it has none)."""
    start = np.zeros(len(gain))
    errors = [each - responses(modes, outlet, gain, each, start) for each in missed]
    covariance = sum(each.T @ each for each in errors) / sum(len(each) for each in errors)
    sign, size = np.linalg.slogdet(covariance)
    return errors, covariance, float(size) if sign > 0 else np.inf
