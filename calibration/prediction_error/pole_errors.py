"""Standard errors of natural frequencies and damping ratios from a fit's free parameters."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calibration.prediction_error.element import pole_slopes
from calibration.prediction_error.gauss_newton import Fit
from calibration.prediction_error.local_coordinates import Coordinates
from calibration.prediction_error.normal_equations import Record, score_covariance
from calibration.state_space.modes import Modes, modes


@dataclass(frozen=True, eq=False)
class ModeErrors:
    """Modes of a fitted system with one standard error each.

    Parameters
    ----------
    modes : Modes
    frequency : array, shape (modes,), Hz
    damping : array, shape (modes,), 1
        Not a number for a pole at zero, which has neither.
    """

    modes: Modes
    frequency: np.ndarray
    damping: np.ndarray


def white_covariance(fit: Fit) -> np.ndarray:
    """Return the free parameters' covariance, shape (free, free), where the residuals are the innovations.

    Source
    ------
    Ljung, System Identification, 2nd ed., 1999, section 9.4: the inverse of the Gauss-Newton Hessian.
    """
    return np.linalg.pinv(fit.normal.information, hermitian=True)


def coloured_covariance(fit: Fit, records: Sequence[Record]) -> np.ndarray:
    """Return the free parameters' covariance, shape (free, free), whatever the spectrum of the residuals.

    Parameters
    ----------
    fit : Fit
    records : sequence of Record

    Source
    ------
    Ljung, System Identification, 2nd ed., 1999, eq. (9.17) and section 9.4; the spectrum of the gradient at zero
    frequency by means over batches.
    """
    inverse = white_covariance(fit)
    at = fit.coordinates
    scores = score_covariance(at.form, at.slopes, records, fit.states, fit.point.weight, fit.normal)
    covariance: np.ndarray = inverse @ scores @ inverse
    return covariance


def mode_errors(at: Coordinates, covariance: np.ndarray, rate: float) -> tuple[ModeErrors, ...]:
    """Return the modes of each element's system with their errors.

    Parameters
    ----------
    at : Coordinates
    covariance : array, shape (free, free), any unit
        Of the steps.
    rate : float, samples/s
    """
    found, start = [], 0
    for element, steps in zip(at.elements, at.steps, strict=True):
        part = slice(start, start := start + len(steps.a))
        poles, slopes = pole_slopes(element.system(), steps.of_system(element))
        found.append(_errors(poles, slopes, covariance[part, part], rate))
    return tuple(found)


def _errors(poles: np.ndarray, slopes: np.ndarray, covariance: np.ndarray, rate: float) -> ModeErrors:
    described = modes(poles, rate)
    order = np.array([np.argmin(np.abs(poles - pole)) for pole in described.pole], int)
    alive = np.abs(poles[order]) > np.finfo(float).tiny
    safe = np.where(alive, poles[order], 1.0)
    s = rate * np.log(safe)
    speed = np.maximum(np.abs(s), np.finfo(float).tiny)
    s_slopes = rate * slopes[order] / safe[:, None]
    along = (s.conj()[:, None] * s_slopes).real / speed[:, None]
    frequency = along / (2 * np.pi)
    damping = -s_slopes.real / speed[:, None] + (s.real / speed**2)[:, None] * along
    spread = [np.sqrt(np.einsum("kf,fg,kg->k", part, covariance, part).clip(0)) for part in (frequency, damping)]
    return ModeErrors(described, *(np.where(alive, part, np.nan) for part in spread))
