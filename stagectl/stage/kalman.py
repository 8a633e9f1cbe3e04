"""The Kalman filter of the outer loop: its gain, from the identified noise and from doubt about the model."""

import numpy as np
from scipy.linalg import solve_discrete_are

from calibration.state_space.model import InnovationModel


class NoGain(ValueError):
    """There is no gain for a model, or its equation is too nearly singular to be solved."""


def kalman_gain(model: InnovationModel, doubt: float, caution: float = 0.0, trust: float = 1.0) -> np.ndarray:
    """Return the gain K of (2.4) for a model that is in doubt.

    To the identified noise it adds white noise at the plant's input and, `caution` times as large, at the input of each
    mode by itself.  Without either the gain is the model's own, which is best for the noise of the experiment and
    trusts the model where it should not.  Noise at the input brings the loop near to state feedback (loop transfer
    recovery), by way of a filter that inverts the plant's zeros; noise at each mode keeps it from relying on those
    zeros, which lie elsewhere as soon as a natural frequency does.

    A gain identified from loud chirps follows hysteresis, which is there only while they are: it takes whatever is
    measured for motion, up to high frequencies.  `trust` tells how much of that noise there is in a run.

    Parameters
    ----------
    model : InnovationModel
        Of one output.
    doubt : float, the input's unit per the output's unit
        Rms of the noise at the input over that of the innovations, >= 0.
    caution : float, 1, >= 0
    trust : float, 1, 0 to 1
        Part of the model's own gain.

    Returns
    -------
    array, shape (n, 1), 1 per the output's unit

    Raises
    ------
    NoGain : its equation is too nearly singular to be solved.

    Source
    ------
    Sörnmo 2015, eq. (2.4); recovery: Doyle and Stein, IEEE Trans. Automatic Control 26 (1981) 4.
    """
    own = trust * model.K
    if doubt == 0:
        return own
    modes = caution * np.hstack([part @ model.B for part in modal_parts(model.A)])
    inputs = doubt * np.hstack([model.B, modes])
    noise = own @ own.T + inputs @ inputs.T  # per variance of the innovations
    one = np.ones((1, 1))
    try:
        covariance = solve_discrete_are(model.A.T, model.C.T, noise, one, s=own)
    except np.linalg.LinAlgError as fault:
        raise NoGain(f"there is no Kalman gain for this model: {fault}") from None
    gain: np.ndarray = (model.A @ covariance @ model.C.T + own) / (model.C @ covariance @ model.C.T + one)
    return gain


def modal_parts(A: np.ndarray) -> list[np.ndarray]:
    """Return for each mode what takes a state to its part in that mode: arrays of shape (n, n), 1, whose sum is one.

    Parameters
    ----------
    A : array, shape (n, n), 1
        With distinct eigenvalues; a mode is a real one or a complex pair.
    """
    poles, shapes = np.linalg.eig(A.astype(complex))
    rows = np.linalg.inv(shapes)
    return [
        (1.0 + (pole.imag > 0)) * np.outer(shapes[:, number], rows[number]).real
        for number, pole in enumerate(poles)
        if pole.imag >= 0
    ]
