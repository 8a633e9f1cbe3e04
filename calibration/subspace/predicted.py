"""Models that may be unstable: B, D and first states from the error one step ahead, which a free run outgrows."""

from collections.abc import Sequence

import numpy as np
from scipy.linalg import LinAlgError

from calibration.subspace.ahead import offset, regress_ahead
from calibration.subspace.estimate import Compressed, Estimate, estimate
from calibration.subspace.kalman_gain import Gain, innovation_gain, is_stable, residual_covariances, riccati_gain
from calibration.subspace.modal import modal
from calibration.subspace.modal_regression import responses
from calibration.subspace.realization import stabilized, state_map, transition
from calibration.subspace.regression import Terms


def estimated(
    compressed: Compressed,
    order: int,
    drives: Sequence[np.ndarray],
    measured: Sequence[np.ndarray],
    terms: Terms,
) -> Estimate:
    """Estimate by the free run, or one step ahead where the model is unstable and may be, or inputs follow outputs.

    Parameters
    ----------
    compressed : Compressed
    order : int
    drives : sequence of arrays, each of shape (N, m), 1
    measured : sequence of arrays, each of shape (N, p), 1
    terms : Terms
    """
    if terms.fed_back:
        return predicted(compressed, order, drives, measured, terms)
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
    """Estimate a model of a given order by the prediction, its poles where they are found unless they are to be stable.

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
    raw, outlet = transition(gamma, layout.outputs)
    matrix = stabilized(raw, max(len(drive) for drive in drives)) if terms.stable else raw
    mapped = state_map(compressed.triangle, layout, gamma, compressed.method)
    gain = innovation_gain(compressed.triangle, layout, mapped, (matrix, outlet)) if terms.fed_back else None
    if gain is None:
        gain = riccati_gain(matrix, outlet, *residual_covariances(compressed.triangle, layout, mapped, matrix, outlet))
    if gain is None:
        raise LinAlgError(f"no gain makes a stable predictor of order {order}")
    predictor = modal(matrix - gain.matrix @ outlet)
    found, known = regress_ahead(predictor, outlet, gain, drives, measured, terms)
    errors = [
        response
        - told
        - found.constant
        - drive @ found.direct.T
        - responses(predictor, outlet, found.inlet, drive, state)
        for drive, response, told, state in zip(drives, measured, known, found.states, strict=True)
    ]
    power = sum(each.T @ each for each in errors)
    return Estimate(
        matrix,
        found.inlet + gain.matrix @ found.direct,
        outlet,
        found.direct,
        offset(matrix, outlet, gain, found.constant),
        Gain(gain.matrix, power / sum(len(each) for each in errors), gain.by_riccati),
        found.states,
        int(np.sum(np.abs(np.linalg.eigvals(raw)) >= 1)) if terms.stable else 0,
        float(np.trace(power)),
    )
