"""How well a model fits a record: NRMSE, VAF and MAE of its free run and one step ahead, and tests of its residuals."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calibration.residual_tests import LAGS, CrossCorrelation, Whiteness, cross_correlation, whiteness
from calibration.state_space.model import InnovationModel

_ROUNDING = 1e-12
"""Of what is missed: an output that moves less does not move."""


@dataclass(frozen=True)
class Measures:
    """Per output, how near a modelled response comes to the measured one.

    Parameters
    ----------
    nrmse : array, shape (p,), %
        100: all of it; 0: no better than the mean; below 0: worse.
    vaf : array, shape (p,), %
        Variance accounted for.
    mae : array, shape (p,), the outputs' units
        Mean absolute error.
    """

    nrmse: np.ndarray
    vaf: np.ndarray
    mae: np.ndarray


@dataclass(frozen=True)
class Fit:
    """A model against a record.

    Parameters
    ----------
    free_run : Measures
        Of the response to the drive alone, from the initial state that fits best; not numbers of an unstable model.
    one_step : Measures
        Of each sample as predicted from those before it, from the initial state that fits best.
    from_rest : Measures
        The same from the zero state, as one begins who knows nothing.
    whiteness : Whiteness
        Of the residuals one step ahead.
    cross_correlation : CrossCorrelation
        Of the residuals one step ahead with the drive.
    """

    free_run: Measures
    one_step: Measures
    from_rest: Measures
    whiteness: Whiteness
    cross_correlation: CrossCorrelation


def nrmse(measured: np.ndarray, modelled: np.ndarray) -> np.ndarray:
    """Return the normalized root mean square fit of each output, %, shape (p,).

    Parameters
    ----------
    measured, modelled : arrays, shape (N, p), any unit

    Source
    ------
    Sörnmo 2015, eq. (2.7).

    Examples
    --------
    >>> nrmse(np.array([[0.0], [2.0]]), np.array([[0.0], [1.0]])).round(3)
    array([29.289])
    """
    missed = np.linalg.norm(measured - modelled, axis=0)
    moved = np.linalg.norm(measured - measured.mean(axis=0), axis=0)
    return 100 * (1 - _share(missed, moved))


def vaf(measured: np.ndarray, modelled: np.ndarray) -> np.ndarray:
    """Return the variance of each output that the model accounts for, %, shape (p,): 100 (1 - var(error) / var).

    Parameters
    ----------
    measured, modelled : arrays, shape (N, p), any unit
    """
    return 100 * (1 - _share(np.var(measured - modelled, axis=0), np.var(measured, axis=0)))


def mae(measured: np.ndarray, modelled: np.ndarray) -> np.ndarray:
    """Return the mean absolute error of each output, the signals' unit, shape (p,).

    Parameters
    ----------
    measured, modelled : arrays, shape (N, p), any unit

    Source
    ------
    Sörnmo 2015, eq. (2.8).
    """
    error: np.ndarray = np.mean(np.abs(measured - modelled), axis=0)
    return error


def measures(measured: np.ndarray, modelled: np.ndarray) -> Measures:
    """Measure NRMSE, VAF and MAE.

    Parameters
    ----------
    measured, modelled : arrays, shape (N, p), any unit
    """
    return Measures(nrmse(measured, modelled), vaf(measured, modelled), mae(measured, modelled))


def free_run(model: InnovationModel, drive: np.ndarray, response: np.ndarray) -> np.ndarray:
    """Return the response to a drive alone, shape (N, p), from the state that suits a measured one best.

    Not numbers of an unstable model, which has none.

    Parameters
    ----------
    model : InnovationModel
    drive : array, shape (N, m), the inputs' units
    response : array, shape (N, p), the outputs' units
    """
    if not model.is_stable:
        return np.full_like(response, np.nan)
    return model.simulate(drive, model.initial_state(drive, response))


def one_step(model: InnovationModel, drive: np.ndarray, response: np.ndarray) -> np.ndarray:
    """Return each sample as predicted from those before it, shape (N, p), from the state that suits them best.

    Parameters
    ----------
    model : InnovationModel
    drive : array, shape (N, m), the inputs' units
    response : array, shape (N, p), the outputs' units
    """
    return model.predict(drive, response, model.initial_predictor_state(drive, response))


def fit(
    model: InnovationModel,
    drives: Sequence[np.ndarray],
    responses: Sequence[np.ndarray],
    lags: int = LAGS,
    fitted: int = 0,
) -> Fit:
    """Hold a model against one or more records, each from the initial state that suits it best.

    Parameters
    ----------
    model : InnovationModel
    drives : sequence of arrays, each of shape (N, m), the inputs' units
        Deviations from the operating point the model was identified at.
    responses : sequence of arrays, each of shape (N, p), the outputs' units
        As `drives`.
    lags : int, samples
        Of the residuals' correlations, at most: half of the longest record, and of records that are longer than that.
    fitted : int
        Coefficients of the noise model that were fitted to these very records; 0 on fresh data.
    """
    free, ahead, rested = [], [], []
    for drive, response in zip(drives, responses, strict=True):
        free.append(free_run(model, drive, response))
        ahead.append(one_step(model, drive, response))
        rested.append(model.predict(drive, response))
    measured = np.concatenate(responses)
    residuals = [response - predicted for response, predicted in zip(responses, ahead, strict=True)]
    lags = max(1, min(lags, max(map(len, residuals)) // 2))
    long, pushed = ([each for each in side if len(each) > lags] for side in (residuals, drives))
    return Fit(
        measures(measured, np.concatenate(free)),
        measures(measured, np.concatenate(ahead)),
        measures(measured, np.concatenate(rested)),
        whiteness(long, lags, fitted),
        cross_correlation(long, pushed, lags),
    )


def _share(missed: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """Divide; an output that never moves is missed wholly unless nothing is missed."""
    still = moved <= _ROUNDING * missed
    return np.where(still, np.where(missed == 0, 0.0, np.inf), missed / np.where(still, 1.0, moved))
