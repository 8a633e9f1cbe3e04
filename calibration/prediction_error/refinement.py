"""Refine an innovation-form state space by the prediction error method, from a first estimate."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from calibration.one_thread import on_one_thread
from calibration.prediction_error.element import LARGEST_MODULUS, ROUNDING, Element, balanced
from calibration.prediction_error.gauss_newton import Effort, Fit, fit, unseen
from calibration.prediction_error.local_coordinates import free, gain_only
from calibration.prediction_error.normal_equations import Record
from calibration.prediction_error.pole_errors import ModeErrors, coloured_covariance, mode_errors, white_covariance
from calibration.prediction_error.scale import Scale, scale_of
from calibration.prediction_error.sensitivities import Sensitivities, of_prediction, of_simulation
from calibration.records import as_records
from calibration.state_space.model import InnovationModel

ITERATIONS = 200

Focus = Literal["prediction", "simulation"]


@dataclass(frozen=True, eq=False)
class Refined:
    """A refined model.

    Parameters
    ----------
    model : InnovationModel
    errors : ModeErrors
        Its modes with their standard errors.
    iterations : int
    arrived : bool
        Whether the fit ended at an optimum, rather than at the limit of iterations or time, or where no step helps.
    sensitivities : Sensitivities
        How its matrices follow what was fitted: for the errors of its responses.
    """

    model: InnovationModel
    errors: ModeErrors
    iterations: int
    arrived: bool
    sensitivities: Sensitivities


@on_one_thread
def refine(
    model: InnovationModel,
    drive: np.ndarray | Sequence[np.ndarray] | None,
    response: np.ndarray | Sequence[np.ndarray],
    *,
    focus: Focus = "prediction",
    direct: bool = True,
    iterations: int = ITERATIONS,
    seconds: float = float("inf"),
    show: Callable[[int, float], object] = unseen,
) -> Refined:
    """Fit every free parameter of a model, and each record's initial state, to records.

    With focus "prediction" the prediction one step ahead is fitted: for Gaussian innovations maximum likelihood, and
    the estimate of least variance.  With focus "simulation" the free run is fitted, output by output, and then K alone
    to the prediction: for a response that no model of this order explains, and for use without measurement.  Either
    way both A and A - K C stay stable.  Memory does not grow with the records.

    Parameters
    ----------
    model : InnovationModel
        To start from, of the order wanted, with A and A - K C stable.
    drive : array, shape (N, m), the inputs' units, or a sequence of such; None where there are no inputs
        Deviations from the operating point, as the model was estimated from.
    response : array, shape (N, p), the outputs' units, or a sequence of such
        As many records as drives.
    focus : "prediction" or "simulation"
    direct : bool
        Whether D is fitted; else it stays zero, and the model's must be.
    iterations : int
        At most.
    seconds : float, s, optional
        At most; a fit that ends by it is `arrived` no more, and another one on another machine.
    show : callable(int, float), optional
        Told of each iteration, and by how much it lowered the criterion, a logarithm of variances.

    Raises
    ------
    ValueError : records that do not fit the model, a model that is not stable.

    Source
    ------
    Ljung, System Identification, 2nd ed., 1999, chapters 7 and 10; McKelvey, Helmersson, Ribarits 2004, Automatica
    40(9), for the coordinates.
    """
    if not seconds > 0:
        raise ValueError(f"seconds is {seconds:g} s, must be > 0")
    effort = Effort(iterations, seconds, show)
    drives, responses = as_records(drive, response)
    _check(model, drives, responses, focus, direct)
    scale = scale_of(drives, responses)
    start = scale.applied(model)
    through = start.D if direct else start.D[:, :0]
    drives, responses = scale.of_drives(drives), scale.of_responses(responses)
    if focus == "simulation":
        return _simulating(start, through, drives, responses, scale, effort)
    inlet = np.hstack([start.B - start.K @ start.D, start.K])
    predictor, _ = balanced(Element(start.A - start.K @ start.C, inlet, start.C, 0, start.inputs))
    records = [Record(np.hstack([u, y]), y) for u, y in zip(drives, responses, strict=True)]
    found = fit([predictor], through, records, free, joint=True, effort=effort)
    refined = _from_predictor(found, start)
    covariance = white_covariance(found)
    errors = mode_errors(found.coordinates, covariance, model.rate)[0]
    moves = of_prediction(found.coordinates, covariance, scale)
    return Refined(scale.removed(refined), errors, found.iterations, found.arrived, moves)


def _simulating(
    start: InnovationModel,
    through: np.ndarray,
    drives: Sequence[np.ndarray],
    responses: Sequence[np.ndarray],
    scale: Scale,
    effort: Effort,
) -> Refined:
    records = [Record(u, y) for u, y in zip(drives, responses, strict=True)]
    element, _ = balanced(Element(start.A, start.B, start.C))
    found = fit([element], through, records, free, joint=False, effort=effort)
    element, still = found.coordinates.elements[0], np.zeros_like(start.K)
    direct = found.point.direct if through.size else start.D
    simulating = replace(start, A=element.a, B=element.b, C=element.c, D=direct, K=still)
    noise = [
        y - simulating.simulate(u, states[0])
        for u, y, states in zip(drives, responses, found.point.states, strict=True)
    ]
    gained = _with_gain(simulating, noise, effort)
    covariance = coloured_covariance(found, records)
    errors = mode_errors(found.coordinates, covariance, start.rate)[0]
    moves = of_simulation(found.coordinates, covariance, scale)
    return Refined(scale.removed(gained), errors, found.iterations, found.arrived, moves)


def _with_gain(model: InnovationModel, noise: Sequence[np.ndarray], effort: Effort) -> InnovationModel:
    """Return the model with the K that predicts best what its free run leaves over."""
    records = [Record(part, part) for part in noise]
    predictor = Element(model.A, model.K, model.C)
    none = np.zeros((model.outputs, 0))
    found = fit([predictor], none, records, gain_only, joint=True, effort=effort)
    return replace(model, K=found.point.elements[0].b, innovation=_symmetric(found.point.covariance))


def _from_predictor(found: Fit, start: InnovationModel) -> InnovationModel:
    element = found.coordinates.elements[0]  # in the basis of the sensitivities
    gain, direct = element.b[:, start.inputs :], found.point.direct if found.point.direct.size else start.D
    return replace(
        start,
        A=element.system(),
        B=element.b[:, : start.inputs] + gain @ direct,
        C=element.c,
        D=direct,
        K=gain,
        innovation=_symmetric(found.point.covariance),
    )


def _symmetric(covariance: np.ndarray) -> np.ndarray:
    symmetric: np.ndarray = (covariance + covariance.T) / 2
    return symmetric


def _check(
    model: InnovationModel, drives: Sequence[np.ndarray], responses: Sequence[np.ndarray], focus: str, direct: bool
) -> None:
    widths = drives[0].shape[1], responses[0].shape[1]
    if widths != (model.inputs, model.outputs):
        raise ValueError(f"records have {widths} inputs and outputs, the model {(model.inputs, model.outputs)}")
    if model.order == 0:
        raise ValueError("the model has no state, must have at least one")
    if focus not in ("prediction", "simulation"):
        raise ValueError(f"focus is {focus!r}, must be 'prediction' or 'simulation'")
    if not direct and np.any(model.D):
        raise ValueError("D is not zero in the model, must be where it is not fitted")
    for name, matrix in (("A", model.A), ("A - K C", model.A - model.K @ model.C)):
        largest = float(np.abs(np.linalg.eigvals(matrix)).max())
        if not largest <= LARGEST_MODULUS + ROUNDING:
            raise ValueError(f"the largest pole of {name} has modulus {largest:.9g}, must be <= {LARGEST_MODULUS}")
