"""Identify a model on the first part of a measurement, and judge it on the rest."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from calibration import subspace
from calibration.fit_measures import Fit, fit
from calibration.one_thread import on_one_thread
from calibration.prediction_error import ModeErrors, refine
from ctlblocks.recording import Recording
from rigkit.provenance import now, software
from stagectl.models import InnovationModel

Method = Literal["n4sid", "moesp", "pem"]
METHODS = ("n4sid", "moesp", "pem")

STEPS = 3
LEAST_HELD_BACK, MOST_HELD_BACK = 0.05, 0.8
"""Share of the samples that may be held back."""


@dataclass(frozen=True, eq=False)
class Identification:
    """A model and what it was judged on.

    Parameters
    ----------
    model : InnovationModel
        Between deviations from the operating point.
    started : subspace.Identified
        The subspace estimate that it is, or that it was refined from.
    method : str
    errors : ModeErrors
        Its modes, with standard errors: by pem from the Hessian of the prediction error, else from a jackknife.
    own, fresh : Fit
        On the part it was identified from, and on the part held back.
    drive, response : arrays, shapes (N, m) and (N, p), the inputs' and the outputs' units
        The part held back, as deviations from the operating point.
    free_run : array, shape (N, p), the outputs' units
        What the model gives for that drive alone, from the initial state that suits it best.
    """

    model: InnovationModel
    started: subspace.Identified
    method: str
    errors: ModeErrors
    own: Fit
    fresh: Fit
    drive: np.ndarray
    response: np.ndarray
    free_run: np.ndarray


def unseen(done: int, name: str) -> None:
    """Show nothing of it."""


@on_one_thread
def identify_recording(
    measured: Recording,
    inputs: int,
    *,
    order: int | None = None,
    method: Method = "moesp",
    horizon: int | None = None,
    hold_back: float = 0.3,
    show: Callable[[int, str], object] = unseen,
) -> Identification:
    """Identify a model between the first `inputs` channels and the others.

    Parameters
    ----------
    measured : Recording
    inputs : int
    order : int, optional
        As many as the singular values and the held back part of the training data propose, where not given.
    method : "n4sid", "moesp" or "pem"
        "pem" refines the result of "moesp" by the prediction error method.
    horizon : int, samples, optional
    hold_back : float, share of the samples, at the end
    show : callable(int, str)
        Told of the steps done, of `STEPS`, and which is next.
    """
    if not LEAST_HELD_BACK <= hold_back <= MOST_HELD_BACK:
        raise ValueError(f"held back are {hold_back} of the samples, must be {LEAST_HELD_BACK} to {MOST_HELD_BACK}")
    if method not in METHODS:
        raise ValueError(f"method is {method!r}, must be one of {', '.join(METHODS)}")
    data = np.asarray(measured.data, float)
    _check_moving(measured, data)
    cut = round(len(data) * (1 - hold_back))
    start: Literal["n4sid", "moesp"] = "n4sid" if method == "n4sid" else "moesp"
    drive, response = data[:, :inputs], data[:, inputs:]
    show(0, "orders and the model")
    found = subspace.identify(drive[:cut], response[:cut], measured.rate, order, start, horizon)
    drive, response = drive - found.input_offset, response - found.output_offset
    show(1, "errors of its modes" if method != "pem" else "the model refined")
    model, errors = _refined(found, drive[:cut], response[:cut]) if method == "pem" else _plain(found)
    model = _labelled(model, measured, inputs, method, cut)
    show(2, "fits")
    late = model.initial_state(drive[cut:], response[cut:])
    return Identification(
        model,
        found,
        method,
        errors,
        fit(model, [drive[:cut]], [response[:cut]], fitted=model.order * model.outputs),
        fit(model, [drive[cut:]], [response[cut:]]),
        drive[cut:],
        response[cut:],
        model.simulate(drive[cut:], late),
    )


def _refined(found: subspace.Identified, drive: np.ndarray, response: np.ndarray) -> tuple[InnovationModel, ModeErrors]:
    refined = refine(found.model, drive, response)
    return refined.model, refined.errors


def _plain(found: subspace.Identified) -> tuple[InnovationModel, ModeErrors]:
    errors = found.pole_errors
    return found.model, ModeErrors(found.model.modes, errors.frequency, errors.damping)


def _check_moving(measured: Recording, data: np.ndarray) -> None:
    for name, channel in zip(measured.names, data.T, strict=True):
        if not np.ptp(channel) > 0:
            raise ValueError(f"channel {name!r} never changes: it has nothing to identify from")


def _labelled(model: InnovationModel, measured: Recording, inputs: int, method: str, cut: int) -> InnovationModel:
    words = {"computed": now(), "software": software(), "method": method, "samples": str(cut)}
    return replace(
        model,
        input_names=measured.names[:inputs],
        output_names=measured.names[inputs:],
        input_units=measured.units[:inputs],
        output_units=measured.units[inputs:],
        provenance={**measured.provenance, **words},
    )
