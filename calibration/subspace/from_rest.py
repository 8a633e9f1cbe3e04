"""A Kalman gain for whoever begins from rest: what a wrong first state costs counts as well."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.linalg import LinAlgError

from calibration.state_space import model_kernel
from calibration.state_space.gramian import summed
from calibration.state_space.model import InnovationModel
from calibration.subspace.kalman_gain import is_stable
from calibration.subspace.riccati import filter_covariance

COST = 0.01
"""Power of what a wrong first state makes of the outputs, re theirs, over the longest record: up to it nothing is done.

As much takes ten points off a fit from rest.
"""
RISE = 1.25
"""By what innovations may grow in the mean over the outputs, to bring that down."""
_ENOUGH = 20_000
"""Samples that tell it."""
_SUPPOSED = 10.0 ** np.arange(-8, 0.5, 0.5)
"""Noise that is supposed to drive the states, re their own spread and, as the innovations are, the outputs'."""

Records = Sequence[np.ndarray]


def from_rest(model: InnovationModel, drives: Records, responses: Records) -> InnovationModel:
    """Return a model whose predictor can begin at zero.

    A predictor of smooth outputs extrapolates them, and answers a first state that it does not know with many times
    the outputs' own size: it predicts best from a state that was fitted to all of the record, and for long not at all
    from rest.  Its gain becomes that of a system with more noise in its states, until a first state as large as the
    records' states costs little or the innovations have grown by `RISE`.

    Parameters
    ----------
    model : InnovationModel
        With a stable predictor.
    drives, responses : sequences of arrays, shapes (N, m) and (N, p), the inputs' and the outputs' units
        Deviations from the operating point.

    Returns
    -------
    InnovationModel
        As it was, or with another K and innovations' covariance.
    """
    longest, samples = max(map(len, drives)), sum(map(len, drives))
    some = [max(4 * model.order, len(each) * min(_ENOUGH, samples) // samples) for each in drives]
    drives, responses = ([each[:most] for each, most in zip(side, some, strict=True)] for side in (drives, responses))
    spread = _states(model, drives, responses)
    if not _cost(model, spread, longest) > COST:
        return model
    predictor, power = model.A - model.K @ model.C, np.trace(model.C @ spread @ model.C.T)
    least, best = _innovations(model, drives, responses), model
    for supposed in _SUPPOSED * np.trace(model.innovation) / power:
        try:
            error = filter_covariance(predictor, model.C, supposed * spread, model.innovation)
            seen = model.C @ error @ model.C.T + model.innovation
            more = np.linalg.solve(seen, (predictor @ error @ model.C.T).T).T
        except (LinAlgError, ValueError):
            continue
        if not is_stable(predictor - more @ model.C):
            continue
        trial = replace(model, K=model.K + more)
        innovations = _innovations(trial, drives, responses)
        if not _growth(innovations, least) <= RISE:
            break
        best = replace(trial, innovation=innovations)
        if _cost(best, spread, longest) <= COST:
            break
    return best


def _growth(larger: np.ndarray, smaller: np.ndarray) -> float:
    """Return by what innovations have grown, in the mean over the outputs."""
    (_, after), (_, before) = np.linalg.slogdet(larger), np.linalg.slogdet(smaller)
    return float(np.exp((after - before) / (2 * len(larger))))


def _cost(model: InnovationModel, spread: np.ndarray, samples: int) -> float:
    """Return the power of the transient of a first state, re that of the output, over so many samples: the worst."""
    transient = summed(model.A - model.K @ model.C, spread)
    power = np.diag(model.C @ spread @ model.C.T)
    return float(np.max(np.diag(model.C @ transient @ model.C.T) / np.maximum(power, np.finfo(float).tiny)) / samples)


def _innovations(model: InnovationModel, drives: Records, responses: Records) -> np.ndarray:
    """Return the covariance of the errors one step ahead, from the states that fit best."""
    total = np.zeros((model.outputs, model.outputs))
    for drive, response in zip(drives, responses, strict=True):
        left = response - model.predict(drive, response, model.initial_predictor_state(drive, response))
        total += left.T @ left
    return total / sum(map(len, drives))


def _states(model: InnovationModel, drives: Records, responses: Records) -> np.ndarray:
    """Return the second moments of the predictor's states, from the first ones that fit best."""
    predictor = model.A - model.K @ model.C
    entering = np.concatenate([model.B - model.K @ model.D, model.K], axis=1)
    still = np.zeros((entering.shape[1], model.order))
    matrices = predictor.T.copy(), entering.T.copy(), np.eye(model.order), still
    total = np.zeros((model.order, model.order))
    for drive, response in zip(drives, responses, strict=True):
        states = np.empty((len(drive), model.order))
        beside = np.ascontiguousarray(np.concatenate([drive, response], axis=1))
        model_kernel.free_run(*matrices, beside, model.initial_predictor_state(drive, response), states)
        total += states.T @ states
    return total / sum(map(len, drives))
