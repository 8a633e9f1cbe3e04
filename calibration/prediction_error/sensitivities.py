"""How a model's matrices follow its free parameters, and with these its responses: their standard errors."""

from dataclasses import dataclass

import numpy as np

from calibration.prediction_error.local_coordinates import Coordinates
from calibration.prediction_error.scale import Scale
from calibration.state_space.model import InnovationModel
from calibration.state_space.response_errors import ResponseErrors, along_and_across


@dataclass(frozen=True, eq=False)
class Sensitivities:
    """Derivatives of A, B, C and D by each free parameter, and the parameters' covariance.

    Parameters
    ----------
    a : array, shape (free, n, n), 1
    b : array, shape (free, n, m), 1 per the inputs' units
    c : array, shape (free, p, n), the outputs' units
    d : array, shape (free, p, m), the outputs' per the inputs' units
    covariance : array, shape (free, free), 1
    """

    a: np.ndarray
    b: np.ndarray
    c: np.ndarray
    d: np.ndarray
    covariance: np.ndarray

    def response_errors(self, model: InnovationModel, frequency: np.ndarray) -> ResponseErrors:
        """Return standard errors of the frequency response.

        Parameters
        ----------
        model : InnovationModel
            Whose sensitivities these are.
        frequency : array, shape (bins,), Hz
        """
        z = np.exp(2j * np.pi * np.asarray(frequency, float) / model.rate)
        apart = z[:, None, None] * np.eye(model.order) - model.A
        driven = np.linalg.solve(apart, model.B.astype(complex)[None])
        rows = np.linalg.solve(apart.transpose(0, 2, 1), model.C.T.astype(complex)[None]).transpose(0, 2, 1)
        spreads = []
        for column, row in zip(driven, rows, strict=True):
            moved = row @ (self.a @ column + self.b) + self.c @ column + self.d
            spreads.append([self._spread(part) for part in along_and_across(model.C @ column + model.D, moved)])
        magnitude, phase = np.array(spreads).transpose(1, 0, 2, 3)
        return ResponseErrors(magnitude, phase)

    def simulation_errors(self, model: InnovationModel, drive: np.ndarray) -> np.ndarray:
        """Return standard errors of what the model responds to inputs from rest, the outputs' units, shape (N, p).

        Parameters
        ----------
        model : InnovationModel
            Whose sensitivities these are.
        drive : array, shape (N, m), the inputs' units
        """
        state, moved = np.zeros(model.order), np.zeros((len(self.a), model.order))
        errors = np.empty((len(drive), model.outputs))
        for sample, u in enumerate(drive):
            errors[sample] = self._spread(moved @ model.C.T + self.c @ state + self.d @ u)
            moved = moved @ model.A.T + self.a @ state + self.b @ u
            state = model.A @ state + model.B @ u
        return errors

    def _spread(self, slopes: np.ndarray) -> np.ndarray:
        """Return the root of the variance of what follows the parameters so, slopes of shape (free, ...)."""
        flat = slopes.reshape(len(slopes), -1)
        variance = np.sum(flat * (self.covariance @ flat), axis=0)
        spread: np.ndarray = np.sqrt(variance.clip(0.0)).reshape(slopes.shape[1:])
        return spread


def of_simulation(at: Coordinates, covariance: np.ndarray, scale: Scale) -> Sensitivities:
    """Return the sensitivities of the system that a fit's one element is, in SI units.

    Parameters
    ----------
    at : Coordinates
        Of one element with a direct path, in scaled units.
    covariance : array, shape (free, free), 1
    scale : Scale
    """
    steps, d = at.steps[0], _of_direct(at)
    return _in_units((steps.a, steps.b, steps.c), d, covariance, scale)


def of_prediction(at: Coordinates, covariance: np.ndarray, scale: Scale) -> Sensitivities:
    """Return the sensitivities of the system that a fit's one element predicts, in SI units.

    Parameters
    ----------
    at : Coordinates
        Of one element, a predictor, with a direct path, in scaled units.
    covariance : array, shape (free, free), 1
    scale : Scale
    """
    element, steps, d = at.elements[0], at.steps[0], _of_direct(at)
    inputs = element.gain_at or 0
    inlet, gained = steps.b[:, :, :inputs], steps.b[:, :, inputs:]
    if at.direct.size:
        inlet = inlet + gained @ at.direct
    found = _in_units((steps.of_system(element), inlet, steps.c), d, covariance, scale)
    if len(d):
        found.b[-len(d) :] += element.b[:, inputs:] @ d / scale.drive  # B is that of the predictor and K D
    return found


def _of_direct(at: Coordinates) -> np.ndarray:
    """Return how D follows its own numbers, shape (numbers, p, m): one each, or none."""
    return np.eye(at.direct.size).reshape(at.direct.size, *at.direct.shape)


def _in_units(
    own: tuple[np.ndarray, np.ndarray, np.ndarray], direct: np.ndarray, covariance: np.ndarray, scale: Scale
) -> Sensitivities:
    """Lay out the element's steps and, after them, those of the direct path; undo the scaling."""
    a, b, c = (np.pad(part, ((0, len(direct)), (0, 0), (0, 0))) for part in own)
    d = np.zeros((len(a), c.shape[1], b.shape[2]))
    if len(direct):
        d[-len(direct) :] = direct
    large = scale.response[:, None]
    return Sensitivities(a, b / scale.drive, large * c, large * d / scale.drive, covariance)
