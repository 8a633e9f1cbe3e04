"""Models that may be unstable: B, D and first states from the error one step ahead, which a free run outgrows."""

from collections.abc import Sequence

import numpy as np
from scipy.linalg import LinAlgError, solve_triangular

from calibration.subspace.estimate import Compressed, Estimate, estimate
from calibration.subspace.kalman_gain import Gain, is_stable, residual_covariances, riccati_gain, whitening
from calibration.subspace.modal import modal
from calibration.subspace.modal_regression import regress, responses, sums
from calibration.subspace.realization import state_map, transition
from calibration.subspace.regression import Terms


def estimated(
    compressed: Compressed,
    order: int,
    drives: Sequence[np.ndarray],
    measured: Sequence[np.ndarray],
    terms: Terms,
) -> Estimate:
    """Estimate by the free run, or one step ahead where the model is unstable and may be.

    Parameters
    ----------
    compressed : Compressed
    order : int
    drives : sequence of arrays, each of shape (N, m), 1
    measured : sequence of arrays, each of shape (N, p), 1
    terms : Terms
    """
    if terms.stable or is_stable(transition(compressed.projection.observability(order), compressed.layout.outputs)[0]):
        return estimate(compressed, order, drives, measured, terms)
    return predicted(compressed, order, drives, measured, terms)


def predicted(
    compressed: Compressed,
    order: int,
    drives: Sequence[np.ndarray],
    measured: Sequence[np.ndarray],
    terms: Terms,
) -> Estimate:
    """Estimate a model of a given order whose poles stay where they are found.

    B and D come from the compressed windows at first, beside the states that the past gives; those tell the noise, and
    so K.  With K known, B, D, the offset and first states are fitted to the error one step ahead of all records.

    Parameters
    ----------
    compressed : Compressed
    order : int
    drives : sequence of arrays, each of shape (N, m), 1
    measured : sequence of arrays, each of shape (N, p), 1
    terms : Terms

    Raises
    ------
    LinAlgError : no gain makes a stable predictor, as of a mode that no output shows.
    """
    layout = compressed.layout
    gamma = compressed.projection.observability(order)
    matrix, outlet = transition(gamma, layout.outputs)
    mapped = state_map(compressed.triangle, layout, gamma)
    gain = riccati_gain(matrix, outlet, *residual_covariances(compressed.triangle, layout, mapped, matrix, outlet))
    if gain is None or not is_stable(matrix - gain.matrix @ outlet):
        raise LinAlgError(f"no gain makes a stable predictor of order {order}")
    predictor = modal(matrix - gain.matrix @ outlet)
    root, rest = whitening(gain.innovation), np.zeros(order)
    known = [responses(predictor, outlet, gain.matrix, each, rest) for each in measured]
    records = [
        sums(predictor, drive, solve_triangular(root, (response - told).T, lower=True).T)
        for drive, response, told in zip(drives, measured, known, strict=True)
    ]
    found = regress(predictor, solve_triangular(root, outlet, lower=True), records, terms)
    direct, level = root @ found.direct, root @ found.constant
    errors = [
        response - told - level - drive @ direct.T - responses(predictor, outlet, found.inlet, drive, state)
        for drive, response, told, state in zip(drives, measured, known, found.states, strict=True)
    ]
    power = sum(each.T @ each for each in errors)
    return Estimate(
        matrix,
        found.inlet + gain.matrix @ direct,
        outlet,
        direct,
        offset(matrix, outlet, gain.matrix, level),
        Gain(gain.matrix, power / sum(len(each) for each in errors), by_riccati=True),
        found.states,
        0,
        float(np.trace(power)),
    )


def offset(transition: np.ndarray, outlet: np.ndarray, gain: np.ndarray, level: np.ndarray) -> np.ndarray:
    """Return the offset of the outputs, shape (p,), that a predictor which is fed all of them shows as a level.

    Of an integrator any offset gives the level zero: then the shortest.

    Parameters
    ----------
    transition : array, shape (n, n), 1
    outlet : array, shape (p, n), any unit
    gain : array, shape (n, p), 1 per the outputs' units
    level : array, shape (p,), the outputs' units
    """
    settled = np.linalg.solve(np.eye(len(transition)) - transition + gain @ outlet, gain)
    shown = np.eye(len(outlet)) - outlet @ settled
    found: np.ndarray = np.linalg.lstsq(shown, level, rcond=1e-6)[0]
    return found
