"""Subspace identification: records in, a model in innovation form (2.1) out."""

from dataclasses import replace
from typing import Any

import numpy as np

from calibration.gaps import without_gaps
from calibration.one_thread import on_one_thread
from calibration.records import Side, sides_of
from calibration.subspace.choice import choose
from calibration.subspace.estimate import Estimate, compress, estimate
from calibration.subspace.gain_refinement import refine_gain
from calibration.subspace.identified import Identified
from calibration.subspace.kalman_gain import Gain
from calibration.subspace.realization import Method
from calibration.subspace.regression import Terms
from calibration.subspace.signals import Detrend, Signals, signals
from calibration.subspace.weighting import left_by_free_run, weighted
from calibration.subspace.windows import Windows
from stagectl.models import InnovationModel

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
    method: Method = "moesp",
    direct: bool = True,
    detrend: Detrend = "mean",
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
        Names and units of channels are those of a table's columns: "force [N]".
    y : array, shape (N, p) or (N,), list or table as `u`, or a sequence of such, the outputs' units
        As many samples as `u`, record by record.
    rate : float, samples/s
    order : int, optional
        States.  Where order or horizon are not given, models of several are identified from parts of the records and
        held against the part that each has not seen; what is left of its free run and of its prediction one step ahead
        decides.  `candidates` of the result tells of all of them.
    horizon : int or (past, future), samples, optional
        Longer ones are tried as well where an oscillation that is found takes more than half of it.
    method : "n4sid" or "moesp", optional
        Which projection's singular values are taken.  On inputs that excite all frequencies both give nearly the same;
        on chirps and other inputs that their own future tells, the oblique projection of N4SID is the weaker one.
    direct : bool, optional
        Whether D is fitted; it is 0 otherwise.
    detrend : "mean" or "none", optional
        Whether there is an operating point, the inputs' mean over all records and what the outputs are there, or it is
        zero.

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
    if method not in ("n4sid", "moesp"):
        raise ValueError(f"method is {method!r}, must be 'n4sid' or 'moesp'")
    if not (np.isfinite(rate) and rate > 0):
        raise ValueError(f"rate is {rate}, must be > 0 samples/s")
    inputs, outputs = sides_of(u, y)
    drives, responses = without_gaps(inputs.records, outputs.records)
    data = signals(drives, responses, detrend)
    terms = Terms(direct, constant=detrend == "mean")
    layout, chosen, tried = choose(data, horizon, order, method, terms)
    windows = Windows(data.joined, layout, _SEGMENTS, terms.constant)
    compressed = compress(windows, method)
    found = estimate(compressed, chosen, data.drives, data.responses, terms)
    left = left_by_free_run(found, data.drives, data.responses)
    gain = refine_gain(found.transition, found.outlet, found.gain, left)
    found = weighted(found, gain, data.drives, data.responses, terms)
    return Identified(
        model=_named(_in_units(found, gain, data, rate), inputs, outputs),
        singular_values=compressed.projection.singular_values,
        candidates=tried,
        horizon=(windows.layout.past, windows.layout.future),
        input_offset=data.input_offset,
        output_offset=data.output_offset + data.output_scale * found.constant,
        moved_poles=found.moved,
        by_riccati=found.gain.by_riccati,
        method=method,
        windows=windows,
        drives=tuple(drives),
        responses=tuple(responses),
    )


def _in_units(found: Estimate, gain: Gain, data: Signals, rate: float) -> InnovationModel:
    """Undo the scaling."""
    small, large = data.input_scale, data.output_scale
    return InnovationModel(
        found.transition,
        found.inlet / small,
        large[:, None] * found.outlet,
        large[:, None] * found.direct / small,
        gain.matrix / large,
        rate,
        large[:, None] * gain.innovation * large,
    )


def _named(model: InnovationModel, inputs: Side, outputs: Side) -> InnovationModel:
    """Return a model that has its channels' names and units."""
    return replace(
        model,
        input_names=inputs.names,
        output_names=outputs.names,
        input_units=inputs.units,
        output_units=outputs.units,
    )
