"""Identify a model on the first part of each recording, and judge it on the rest."""

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from calibration import subspace
from calibration.fit_measures import Fit, fit, free_run, one_step
from calibration.identification.excitation import Nearly, nearly_collinear
from calibration.one_thread import on_one_thread
from calibration.prediction_error import ModeErrors, refine
from calibration.residual_tests import LAGS
from calibration.state_space.model import InnovationModel
from calibration.subspace.naming import by_name
from calibration.subspace.outliers import Outliers, outlier_notes, treated
from calibration.subspace.signals import Detrend
from ctlblocks.recording import Recording
from rigkit.provenance import now, software

Method = Literal["auto", "moesp", "n4sid", "pbsid", "pem"]
METHODS = get_args(Method)

Pair = tuple[list[np.ndarray], list[np.ndarray]]
"""Inputs and outputs, record by record."""

STEPS = 3
REFINED = 120.0
"""s of the clock in which "pem" ends, arrived or not."""
LEAST_HELD_BACK, MOST_HELD_BACK = 0.05, 0.8
"""Share of the samples that may be validation data."""


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
        On the part it was identified from, and on the validation data.
    drive, response : arrays, shapes (N, m) and (N, p), the inputs' and the outputs' units
        The validation data, recording after recording, as deviations from the operating point.
    free_run : array, shape (N, p), the outputs' units
        What the model gives for that drive alone, in each recording from the initial state that suits it best; without
        inputs, or where it is not stable, what it predicts one step ahead.
    nearly : tuple of Nearly
        Bands in which inputs nearly go together.
    notes : tuple of str
        What identification warned of.
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
    nearly: tuple[Nearly, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def runs_free(self) -> bool:
        """Whether the model can run without measured outputs."""
        return self.model.inputs > 0 and self.model.is_stable

    @property
    def order(self) -> int:
        """States, those that hold inputs which come late left out."""
        return self.started.core.order


@dataclass(frozen=True)
class Plant:
    """What is known of a plant, as of `subspace.identify`, which describes each.

    Parameters
    ----------
    stable : bool
    delay : "auto", int or tuple of int, samples
    detrend : "mean", "record", "linear", "slow" or "none"
    direct : "auto" or bool
    """

    stable: bool = True
    delay: Literal["auto"] | int | tuple[int, ...] = "auto"
    detrend: Detrend = "mean"
    direct: Literal["auto"] | bool = "auto"


PLANT = Plant()


def unseen(done: int, name: str) -> None:
    """Show nothing of it."""


@on_one_thread
def identify_recordings(
    recordings: Sequence[Recording],
    inputs: int,
    *,
    order: int | None = None,
    method: Method = "auto",
    horizon: int | None = None,
    hold_back: float = 0.3,
    outliers: Outliers = "replace",
    plant: Plant = PLANT,
    seconds: float = REFINED,
    show: Callable[[int, str], object] = unseen,
) -> Identification:
    """Identify a model between the first `inputs` channels and the others.

    Recordings are experiments of their own: each has a first state, and no sample of one predicts another's.  They have
    one operating point.

    Parameters
    ----------
    recordings : sequence of Recording
        Of one rate, with the same channels, of any lengths.
    inputs : int
    order : int, optional
        As many as the singular values and a validation part of the training data propose, where not given.
    method : "auto", "moesp", "n4sid", "pbsid" or "pem"
        "auto" is "moesp", and "pbsid" refined where inputs follow from outputs; "pem" refines either by the prediction
        error method.
    horizon : int, samples, optional
    hold_back : float, share of the samples, at the end of each recording
    outliers : "replace" or "keep"
        What becomes of single samples of outputs that are far off, those of the validation data among them.
    plant : Plant, optional
        What is known of it.
    seconds : float, s
        In which "pem" ends, arrived or not.
    show : callable(int, str)
        Told of the steps done, of `STEPS`, and which is next.

    Raises
    ------
    ValueError : recordings that are unusable or too short, or inputs that cannot be told apart.
    """
    if not LEAST_HELD_BACK <= hold_back <= MOST_HELD_BACK:
        raise ValueError(
            f"the validation share is {hold_back} of the samples, must be {LEAST_HELD_BACK} to {MOST_HELD_BACK}"
        )
    if method not in METHODS:
        raise ValueError(f"method is {method!r}, must be one of {', '.join(METHODS)}")
    records, first = [np.asarray(each.data, float) for each in recordings], recordings[0]
    _check_moving(first.names, records)
    nearly = nearly_collinear([each[:, :inputs] for each in records], first.rate, first.names[:inputs])
    cuts = [_cut(len(each), number, hold_back) for number, each in enumerate(records, 1)]
    early, late, off = _parts(records, cuts, inputs, outliers)
    show(0, "orders and the model")
    found, told = _started(early, first.rate, order, horizon, method, plant)
    notes = by_name((*told, *off, *found.diagnosis.of_records), first.names[:inputs], first.names[inputs:])
    early, late = _about(early, found), _about(late, found)
    show(1, "errors of its modes" if method != "pem" else "the model refined")
    model, errors, ended = _refined(found, early, seconds, show) if method == "pem" else _plain(found)
    method = "pem" if method == "pem" else found.method
    model = _labelled(model, first, inputs, method, sum(cuts))
    show(2, "fits")
    own, fresh = fit(model, *early, fitted=found.core.order * model.outputs), fit(model, *late)
    shown = free_run if inputs and model.is_stable else one_step
    runs = [shown(model, drive, heard) for drive, heard in zip(*late, strict=True)]
    drive, response, modelled = (np.concatenate(each) for each in (*late, runs))
    return Identification(model, found, method, errors, own, fresh, drive, response, modelled, nearly, (*notes, *ended))


def shortest_recording(hold_back: float) -> int:
    """Return how many samples a recording must have for enough of them to be validation data.

    Parameters
    ----------
    hold_back : float, share of the samples
    """
    return math.ceil((LAGS + 1) / min(max(hold_back, LEAST_HELD_BACK), MOST_HELD_BACK)) + 1


def _cut(samples: int, number: int, hold_back: float) -> int:
    """Return how many samples of a recording a model is identified from; refuse one that leaves too few to judge by."""
    cut = round(samples * (1 - hold_back))
    if not samples - cut > LAGS:
        raise ValueError(
            f"recording {number} has {samples} samples, of which {samples - cut} would be validation data, must be "
            f"more than {LAGS}: take a larger share, or leave it out"
        )
    return cut


def _parts(
    records: Sequence[np.ndarray], cuts: Sequence[int], inputs: int, outliers: Outliers
) -> tuple[Pair, Pair, tuple[str, ...]]:
    """Return what models are identified from, what they are judged on, and what is said of samples far off.

    Outliers are sought in training data alone, then in all of the record for the validation part.
    """
    drives, responses = _sides([each[:cut] for each, cut in zip(records, cuts, strict=True)], inputs)
    clean, found = treated(drives, responses, outliers)
    every, whole = _sides(records, inputs)
    whole, everywhere = treated(every, whole, outliers)
    later, clean_later, found_later = (
        [each[cut:] for each, cut in zip(side, cuts, strict=True)] for side in (every, whole, everywhere)
    )
    said = *outlier_notes(found), *(f"of the validation data, {sentence}" for sentence in outlier_notes(found_later))
    return (drives, clean), (later, clean_later), said


def _started(
    records: Pair, rate: float, order: int | None, horizon: int | None, method: Method, plant: Plant
) -> tuple[subspace.Identified, list[str]]:
    """Return the subspace estimate, and what it warned of."""
    start: Literal["auto"] | subspace.Method = "auto" if method == "pem" else method
    delay = 0 if method == "pem" and plant.delay == "auto" else plant.delay
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = subspace.identify(
            *_given(records),
            rate,
            order=order,
            horizon=horizon,
            method=start,
            direct=plant.direct,
            detrend=plant.detrend,
            stable=plant.stable,
            delay=delay,
            outliers="keep",
        )
    return found, [str(each.message) for each in told]


def _given(records: Pair) -> tuple[list[np.ndarray] | None, list[np.ndarray]]:
    """Return inputs, None where there are none, and outputs."""
    drives, responses = records
    return drives if drives[0].shape[1] else None, responses


def _about(sides: Pair, found: subspace.Identified) -> Pair:
    """Return deviations from the operating point."""
    drives, responses = sides
    return [each - found.input_offset for each in drives], [each - found.output_offset for each in responses]


def _sides(records: Sequence[np.ndarray], inputs: int) -> Pair:
    """Return inputs and outputs of records (N, inputs + outputs)."""
    return [each[:, :inputs] for each in records], [each[:, inputs:] for each in records]


def _refined(
    found: subspace.Identified,
    records: Pair,
    seconds: float,
    show: Callable[[int, str], object],
) -> tuple[InnovationModel, ModeErrors, tuple[str, ...]]:
    """Refine a model; return it, its errors, and what is to be said of how it ended."""

    def told(number: int, gain: float) -> None:
        show(1, f"iteration {number}: the criterion is lower by {gain:.1g}")

    done = refine(found.model, *_given(records), direct=found.method != "pbsid", seconds=seconds, show=told)
    ended = (
        f"the refinement ended after {done.iterations} iterations, before it arrived; at most {seconds:g} s are given"
    )
    return done.model, done.errors, () if done.arrived else (ended,)


def _plain(found: subspace.Identified) -> tuple[InnovationModel, ModeErrors, tuple[str, ...]]:
    errors = found.pole_errors
    return found.model, ModeErrors(found.core.modes, errors.frequency, errors.damping), ()


def _check_moving(names: Sequence[str], records: Sequence[np.ndarray]) -> None:
    for name, *channel in zip(names, *(each.T for each in records), strict=True):
        if not np.ptp(np.concatenate(channel)) > 0:
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
