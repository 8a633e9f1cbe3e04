"""G_R of one direction: a third-order model behind a delay, and how far what was measured is from it."""

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from calibration.fit_measures import nrmse
from calibration.local_polynomial import local_polynomial
from calibration.milling.response_fit import fit_response
from stagectl.robot.milling.axis_model import AxisModel
from stagectl.robot.milling.zero_phase import low_pass

REACH, DEGREE = 8, 2
"""Lines to each side of a local polynomial for the measured response, and its degree."""
EVERY = 4
"""Of the lines one in so many is kept."""
SURE = 2.0
"""Standard deviations of the measured response by which it may be off."""
AT_REST = 10.0
"""Lines that rest counts for: there the robot goes as far as it is asked."""


@dataclass(frozen=True, eq=False)
class AxisFit:
    """G_R of one direction.

    Parameters
    ----------
    model : AxisModel
    own, fresh : float, %
        NRMSE of the free run on the chirp it was fitted to, and on the one for validation.
    frequency : array, shape (bins,), Hz
    measured : complex array, shape (bins,), 1
        The response of both chirps without a model.
    spread : array, shape (bins,), 1
        By which that may be off.
    """

    model: AxisModel
    own: float
    fresh: float
    frequency: np.ndarray
    measured: np.ndarray
    spread: np.ndarray


def fit_axis(
    drives: tuple[np.ndarray, ...], responses: tuple[np.ndarray, ...], rate: float, highest: float, cutoff: float
) -> AxisFit:
    """Fit one direction.

    The model is the nearest to the measured response of the first chirp, weighed by what is learned: by Q.

    Parameters
    ----------
    drives, responses : two arrays each, shape (N,), m
        Sent, and reported: the chirp to fit to and the one for validation, beside the steady feed, from zero.
    rate : float, samples/s
    highest, cutoff : float, Hz
        Up to where it is measured, and of Q.

    Raises
    ------
    ValueError : a response that does not move.
    """
    if not np.ptp(responses[0]) > 0.1 * np.ptp(drives[0]):
        raise ValueError(
            f"the robot moved by {1e3 * np.ptp(responses[0]):.3g} mm where it was asked for "
            f"{1e3 * np.ptp(drives[0]):.3g} mm: it does not follow"
        )
    frequency, measured, _ = _measured(drives[:1], responses[:1], rate, highest)
    weight = np.concatenate([[np.sqrt(AT_REST)], np.sqrt(low_pass(frequency, cutoff))])
    known = np.concatenate([[0.0], frequency]), np.concatenate([[1.0], measured])
    model = fit_response(*known, weight, rate)
    own, fresh = (_fit(model, *pair) for pair in zip(drives, responses, strict=True))
    frequency, measured, deviation = _measured(drives, responses, rate, highest)
    return AxisFit(model, own, fresh, frequency, measured, SURE * deviation)


def simulated(model: AxisModel, drive: np.ndarray) -> np.ndarray:
    """Return the model's response from rest, shape (N,), m, to a drive, shape (N,), m.

    Parameters
    ----------
    model : AxisModel
    drive : array, shape (N,), m
    """
    late = np.concatenate([np.zeros(model.delay), drive])[: len(drive)]
    return np.asarray(lfilter(np.concatenate([[0.0], model.numerator]), model.denominator, late))


def _fit(model: AxisModel, drive: np.ndarray, response: np.ndarray) -> float:
    return float(nrmse(response[:, None], simulated(model, drive)[:, None])[0])


def _measured(
    drives: tuple[np.ndarray, ...], responses: tuple[np.ndarray, ...], rate: float, highest: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return frequencies, response and its standard deviation, from all chirps' lines by local polynomials."""
    lines = np.fft.rfftfreq(len(drives[0]), 1.0 / rate)
    spectra = [[np.fft.rfft(each) for each in side] for side in (drives, responses)]
    power = np.sum([np.abs(u) ** 2 for u in spectra[0]], axis=0)
    cross = np.sum([y * u.conj() for u, y in zip(*spectra, strict=True)], axis=0)
    ratio = cross / np.maximum(power, np.finfo(float).tiny)
    inside = (lines > 0) & (lines <= highest)
    wanted = lines[inside][REACH:-REACH:EVERY]
    smooth = local_polynomial(lines[inside], ratio[inside], wanted, REACH, DEGREE)
    return wanted, smooth.value, np.sqrt(smooth.variance)
