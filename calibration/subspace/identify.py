"""Subspace identification: records in, a model in innovation form (2.1) out."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from calibration.gaps import without_gaps
from calibration.one_thread import on_one_thread
from calibration.records import Side, sides_of
from calibration.state_space.model import InnovationModel
from calibration.subspace import asked
from calibration.subspace.choice import Choice, choose
from calibration.subspace.delays import Delays, advanced, delayed, delays
from calibration.subspace.estimate import Estimate, compress
from calibration.subspace.excitation import repeated
from calibration.subspace.feedback import Feedback, feedback
from calibration.subspace.from_rest import from_rest
from calibration.subspace.gain_refinement import refine_gain
from calibration.subspace.identified import Identified
from calibration.subspace.kalman_gain import Gain, is_stable
from calibration.subspace.naming import by_name
from calibration.subspace.operating_point import rest_near
from calibration.subspace.outliers import Outliers, outlier_notes, treated
from calibration.subspace.predicted import estimated
from calibration.subspace.realization import Method
from calibration.subspace.regression import Terms
from calibration.subspace.replicates import Resampling, in_units
from calibration.subspace.signals import Detrend, Signals, levelled, signals
from calibration.subspace.trials import ALIKE
from calibration.subspace.weighting import left_by_free_run, weighted
from calibration.subspace.windows import Windows
from calibration.warned import warn

FEW = 10
"""Samples of delay that a model can as well have as states: then both are chosen freely before they are compared."""
_SEGMENTS = 16
"""That can be left out, for the uncertainty of poles."""


@on_one_thread
def identify(
    u: Any,
    y: Any,
    rate: float,
    *,
    order: int | None = None,
    horizon: int | tuple[int, int] | None = None,
    method: Literal["auto"] | Method = "auto",
    direct: Literal["auto"] | bool = "auto",
    detrend: Detrend = "mean",
    stable: bool = True,
    delay: Literal["auto"] | int | Sequence[int] = "auto",
    outliers: Outliers = "replace",
) -> Identified:
    """Identify a state-space model with its Kalman gain from one or more records.

    A and C come from the shift of the observability matrix, B, D and first states by least squares on the free run, K
    from the Riccati equation and then by Gauss-Newton steps on the error one step ahead; with K known, B and D once
    more, weighted by the noise's colour, unless that costs the free run more than noise explains.  The model is stable:
    poles on or outside of the unit circle are moved inside before B and D are fitted.

    Parameters
    ----------
    u : array, shape (N, m) or (N,), list, pandas or polars table, or a sequence of such, the inputs' units
        One record, or several of any lengths.  Where samples are not finite a record ends, and another one begins.
        Names and units of channels are those of a table's columns: "force [N]".  None where there are no inputs: then
        the model is of a time series, to be predicted, and the prediction one step ahead alone decides.
    y : array, shape (N, p) or (N,), list or table as `u`, or a sequence of such, the outputs' units
        As many samples as `u`, record by record.
    rate : float, samples/s
    order : int, optional
        States.  Where order or horizon are not given, models of several are identified from parts of the records and
        held against the part that each has not seen; what is left of its free run and of its prediction one step ahead
        decides.  `candidates` of the result tells of all of them.
    horizon : int or (past, future), samples, optional
        Longer ones are tried as well where an oscillation that is found takes more than half of it.
    method : "auto", "moesp", "n4sid" or "pbsid", optional
        Which projection's singular values are taken.  On inputs that excite all frequencies those of MOESP and N4SID
        give nearly the same; on chirps and other inputs that their own future tells, the oblique projection of N4SID is
        the weaker one.  Both are wrong where inputs follow from outputs; there "auto" takes PBSID's,
        the prediction one step ahead alone chooses horizon and order, B, D and first states are fitted to it, and all
        of a stable model after that, by prediction error.
    direct : "auto" or bool, optional
        Whether D is fitted; it is 0 otherwise.  "auto": but where inputs follow from outputs, perhaps at once.
    detrend : "mean", "record", "linear", "slow" or "none", optional
        Whether there is an operating point, the inputs' mean over all records and what the outputs are there, or it is
        zero.  With "record" each record has one of its own, with "linear" one that drifts along a line, with "slow"
        one that swings as well, by ten half periods over the record at most: what is taken away from the records leaves
        the mean over all of them.
    stable : bool, optional
        Poles on or outside of the unit circle are moved inside.  False: they stay, and B, D and first states are fitted
        to the prediction one step ahead, which also chooses horizon and order.
    delay : "auto", int or a sequence of int, samples, optional
        Dead time of all inputs, or of each: states of the model that do not count as its order.  "auto": where the
        first three or more lags of an input tell nothing of any output, and a model with them is no worse on what was
        held out.
    outliers : "replace" or "keep", optional
        What becomes of single samples of outputs that are far off, see `without_outliers`; they are told of in a
        warning.

    Raises
    ------
    ValueError : records that are unusable or too short, an order or a horizon that they do not allow.

    Source
    ------
    Sörnmo 2015, section 2.3 and eq. (2.1); Van Overschee and De Moor 1994; Verhaegen 1994.

    Examples
    --------
    >>> u = np.random.default_rng(1).standard_normal(500)
    >>> y = np.zeros(500)
    >>> for n in range(1, 500):
    ...     y[n] = 0.9 * y[n - 1] + 0.5 * u[n - 1]
    >>> found = identify(u, y, rate=100.0)
    >>> found.model.order, round(float(found.model.poles[0].real), 6)
    (1, 0.9)
    """
    asked.check(rate, method, stable, direct)
    order, horizon = asked.order_of(order), asked.horizon_of(horizon)
    given = _given(u, y, detrend, outliers)
    way: Method = method if method != "auto" else "pbsid" if given.loop.inputs else "moesp"
    terms = Terms(way != "pbsid" if direct == "auto" else direct, detrend != "none", stable, way == "pbsid")
    late, heard = _late(given, delay, terms)
    given = given.longer_than(2 * max(late, default=0))
    late, data, chosen = _chosen(given, late, (horizon, order, way, terms), is_compared=heard is not None)
    result = _identified(given, (late, heard), data, chosen, (way, terms, rate))
    if method == "auto" and given.loop.inputs and result.core.is_stable:
        result = _refined(result, terms.direct)
    return _begun(result)


@dataclass(frozen=True)
class _Given:
    """Records without gaps, outliers, and what each is to lose of its own."""

    sides: tuple[Side, Side]
    drives: tuple[np.ndarray, ...]
    responses: tuple[np.ndarray, ...]
    outliers: tuple[np.ndarray, ...]
    loop: Feedback

    def longer_than(self, samples: int) -> "_Given":
        """Return it without shorter records, which are named in a warning."""
        kept = [number for number, drive in enumerate(self.drives) if len(drive) > samples]
        if len(kept) == len(self.drives):
            return self
        lost = len(self.drives) - len(kept)
        warn(f"{lost} record{'s' * (lost > 1)} of at most {samples} samples, twice the dead time, left out")
        sides = ([side[number] for number in kept] for side in (self.drives, self.responses, self.outliers))
        drives, responses, outliers = map(tuple, sides)
        return replace(self, drives=drives, responses=responses, outliers=outliers)


def _given(u: Any, y: Any, detrend: Detrend, outliers: Outliers) -> _Given:
    """Make records ready, with warnings of what is wrong with them, and look for a loop."""
    inputs, outputs = sides_of(u, y)
    drives, responses = without_gaps(inputs.records, outputs.records)
    if pair := repeated(drives):
        first, second = (each + 1 for each in pair)
        warn(f"inputs {first} and {second} are the same signal: they share a response")
    responses, found = treated(drives, responses, outliers)
    for sentence in by_name(outlier_notes(found), (), outputs.names):
        warn(sentence)
    drives, responses = levelled(drives, detrend), levelled(responses, detrend)
    data = signals(drives, responses, has_mean=True)
    loop = feedback(data.drives, data.responses)
    return _Given((inputs, outputs), tuple(drives), tuple(responses), tuple(found), loop)


def _refined(found: Identified, has_direct: bool) -> Identified:
    """Refine the model of a plant in a loop by prediction error, unless its free run is worse then."""
    from calibration.subspace.polish import refined_by_prediction  # slow to import

    refined = refined_by_prediction(found.core, *_about(found), has_direct)
    if refined is None:
        return found
    return replace(found, model=delayed(refined.model, found.delays), core=refined.model, refined=refined)


def _begun(found: Identified) -> Identified:
    """Let the predictor begin at zero."""
    core = from_rest(found.core, *_about(found))
    return found if core is found.core else replace(found, model=delayed(core, found.delays), core=core)


def _about(found: Identified) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Return records without delays, about the operating point."""
    drives, responses = advanced(found.drives, found.responses, found.delays)
    return [each - found.input_offset for each in drives], [each - found.output_offset for each in responses]


def _identified(
    given: _Given,
    heard: tuple[tuple[int, ...], Delays | None],
    data: Signals,
    chosen: Choice,
    how: tuple[Method, Terms, float],
) -> Identified:
    """Return the subspace's estimate at the horizon and order that were chosen."""
    (late, told), (way, terms, rate) = heard, how
    windows, found, gain, values = _fitted(data, chosen, way, terms)
    core = _named(in_units(found, gain, data, rate), *given.sides)
    driven, held = rest_near((found.transition, found.inlet, found.outlet, found.direct), found.constant)
    return Identified(
        model=delayed(core, late),
        core=core,
        delays=late,
        heard=told,
        singular_values=values,
        candidates=chosen.candidates,
        horizon=(windows.layout.past, windows.layout.future),
        input_offset=data.input_offset + data.input_scale * driven,
        output_offset=data.output_offset + data.output_scale * held,
        moved_poles=found.moved,
        by_riccati=found.gain.by_riccati,
        method=way,
        feedback=given.loop,
        resampling=Resampling(windows, data, way, terms, chosen.order),
        drives=given.drives,
        responses=given.responses,
        outliers=given.outliers,
    )


def _late(
    given: _Given, delay: Literal["auto"] | int | Sequence[int], terms: Terms
) -> tuple[tuple[int, ...], Delays | None]:
    """Return what is taken for the delays of the inputs, and what that rests on where it was not given.

    Without D the first lag at which an input is heard is the first one of the model, and no delay.
    """
    longest, inputs = max(len(drive) for drive in given.drives), given.drives[0].shape[1]
    asked_for = asked.delay_of(delay, inputs, longest)
    if asked_for != "auto":
        return asked_for, None
    data = signals(given.drives, given.responses, terms.constant)
    seen = delays(data.drives, data.responses)
    if seen is None:
        return (0,) * inputs, None
    return tuple(max(0, each - (not terms.direct)) for each in seen.of_inputs), seen


def _chosen(
    given: _Given,
    late: tuple[int, ...],
    wanted: tuple[int | tuple[int, int] | None, int | None, Method, Terms],
    is_compared: bool,
) -> tuple[tuple[int, ...], Signals, Choice]:
    """Return the delays of the inputs, records without them, and horizon and order.

    Parameters
    ----------
    given : _Given
    late : tuple of int, samples
    wanted : (horizon, order, method, terms)
    is_compared : bool
        Whether a model without delays is taken where it is better.
    """
    (horizon, order, method, terms), has_mean = wanted, wanted[3].constant
    data = signals(given.drives, given.responses, has_mean)
    if not any(late):
        return late, data, choose(data, *wanted)
    moved = signals(*advanced(given.drives, given.responses, late), has_mean)
    found = choose(moved, horizon, order, method, terms, is_compared=is_compared)
    if is_compared:
        alone = (horizon, order) if max(late) <= FEW else ((found.layout.past, found.layout.future), found.order)
        without = choose(data, *alone, method, terms, is_compared=True)
        if without.score > found.score + ALIKE:
            return (0,) * len(late), data, without if max(late) <= FEW else choose(data, *wanted)
    return late, moved, found


def _fitted(data: Signals, chosen: Choice, method: Method, terms: Terms) -> tuple[Windows, Estimate, Gain, np.ndarray]:
    """Return all windows, an estimate with a better gain, and B and D by what that knows of the noise, and the values.

    An unstable one stays as it is.
    """
    windows, order = Windows(data.joined, chosen.layout, _SEGMENTS, terms.constant), chosen.order
    compressed = compress(windows, method)
    values = compressed.projection.singular_values
    found = estimated(compressed, order, data.drives, data.responses, terms)
    if not is_stable(found.transition):
        return windows, found, found.gain, values
    gain = refine_gain(found.transition, found.outlet, found.gain, left_by_free_run(found, data.drives, data.responses))
    return windows, weighted(found, gain, data.drives, data.responses, terms), gain, values


def _named(model: InnovationModel, inputs: Side, outputs: Side) -> InnovationModel:
    """Return a model that has its channels' names and units."""
    return replace(
        model,
        input_names=inputs.names,
        output_names=outputs.names,
        input_units=inputs.units,
        output_units=outputs.units,
    )
