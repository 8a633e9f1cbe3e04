"""A model of an axis from its chirps: thinned records for poles and order, the stage's own rate for the rest."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from calibration.fit_measures import fit
from calibration.identification.thinning import thinned
from calibration.identification.workflow import Identification
from calibration.one_thread import on_one_thread
from calibration.prediction_error import ModeErrors
from calibration.stage_axes.experiment import Excited, Experiment
from calibration.stage_axes.order import identify
from calibration.state_space.model import InnovationModel
from calibration.subspace.realization import Method

OVER = 5.0
"""Rate of the thinned records, re the highest frequency that is excited, at least."""

Heard = Callable[[Excited], np.ndarray]
"""Returns the outputs of a model from a recorded chirp, shape (N, p), m."""


Convert = Callable[[InnovationModel, Sequence[np.ndarray], Sequence[np.ndarray], float], InnovationModel]


@dataclass(frozen=True)
class Wanted:
    """Which model is wanted.

    Parameters
    ----------
    heard : callable(Excited) -> array
        Its outputs.
    drive : (str, str)
        Name and unit of its input.
    outputs : tuple of str
        Names of its outputs, m.
    order : int or None
        None: as proposed.
    method : "n4sid" or "moesp"
    convert : callable
        Makes a model of thinned records one at the stage's rate: `at_rate`.
    """

    heard: Heard
    drive: tuple[str, str]
    outputs: tuple[str, ...]
    order: int | None
    method: Method
    convert: Convert


@on_one_thread
def identified(
    experiment: Experiment, wanted: Wanted, rate: float, top: float, about: dict[str, str]
) -> Identification:
    """Identify a model from the learned chirps, and judge it on the fresh one, at the stage's rate.

    Parameters
    ----------
    experiment : Experiment
    wanted : Wanted
    rate : float, samples/s
        Of the records and of the model.
    top : float, Hz
        Highest frequency that is excited.
    about : dict of strings
        Provenance.
    """
    factor = max(1, int(rate / (OVER * top)))
    drives = [part.drive for part in experiment.learned]
    responses = [wanted.heard(part) for part in experiment.learned]
    thin_drives, thin_responses = ([thinned(each, factor) for each in side] for side in (drives, responses))
    found = identify(thin_drives, thin_responses, rate / factor, wanted.order, wanted.method)
    low, high = [each - found.input_offset for each in drives], [each - found.output_offset for each in responses]
    model = wanted.convert(found.model, low, high, rate)
    model = replace(
        model,
        input_names=(wanted.drive[0],),
        input_units=(wanted.drive[1],),
        output_names=wanted.outputs,
        output_units=("m",) * len(wanted.outputs),
        provenance=about | {"method": wanted.method, "order": str(model.order)},
    )
    fresh = experiment.fresh.drive - found.input_offset
    response = wanted.heard(experiment.fresh) - found.output_offset
    errors = found.pole_errors
    return Identification(
        model,
        found,
        wanted.method,
        ModeErrors(found.model.modes, errors.frequency, errors.damping),
        fit(model, low, high, fitted=model.order * model.outputs),
        fit(model, [fresh], [response]),
        fresh,
        response,
        model.simulate(fresh, model.initial_state(fresh, response)),
    )


def siso(axis: int) -> Heard:
    """Return what picks the position of one axis, counted from 0."""
    return lambda part: part.position[:, axis : axis + 1]


def simo() -> Heard:
    """Return what picks the positions of all axes."""
    return lambda part: part.position


def stretched(axis: int) -> Heard:
    """Return what picks the extension of one axis, counted from 0."""
    return lambda part: part.extension[:, axis : axis + 1]
