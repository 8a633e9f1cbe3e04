"""The order of an axis' model: where the singular values fall most, among orders that do well on held-back records."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calibration import subspace
from calibration.subspace.estimate import Compressed, Estimate, compress, estimate
from calibration.subspace.order import Candidate
from calibration.subspace.realization import Method
from calibration.subspace.regression import Terms
from calibration.subspace.signals import Signals, signals
from calibration.subspace.windows import Layout, Windows

MARGIN = 3.0
"""Points of NRMSE within which orders do equally well: what loops and creep leave is no state of any model."""
MOST = 14
"""States that are tried at most."""
HORIZON = 40
"""Samples, past and future."""
_TERMS = Terms(direct=True, constant=True)


def proposed(values: np.ndarray, tried: Sequence[Candidate]) -> int:
    """Return the order at which the singular values fall by the largest factor, of those within `MARGIN` of the best.

    Parameters
    ----------
    values : array, shape (count,), 1, falling
    tried : sequence of Candidate

    Examples
    --------
    >>> values = np.array([9.0, 8.0, 0.2, 0.1, 0.01, 0.009])
    >>> fits = {1: 40.0, 2: 93.0, 3: 94.5, 4: 95.0, 5: 95.1}
    >>> proposed(values, [Candidate(order, fit, fit, 40) for order, fit in fits.items()])
    2
    """
    best = max(each.free_run for each in tried)
    good = [each.order for each in tried if each.free_run >= best - MARGIN]
    return max(good, key=lambda order: values[order - 1] / max(values[order], np.finfo(float).tiny))


def tried(drives: Sequence[np.ndarray], responses: Sequence[np.ndarray], method: Method) -> tuple[Candidate, ...]:
    """Identify with every order up to `MOST` from all records but one, and judge on that one; for each in turn.

    Parameters
    ----------
    drives : sequence of arrays, each of shape (N, m), V or m
        Two records or more.
    responses : sequence of arrays, each of shape (N, p), m
    method : "n4sid" or "moesp"

    Returns
    -------
    tuple of Candidate
        By rising order; fits are of all outputs together, in one unit.
    """
    missed, moved = np.zeros((MOST, 2)), 0.0
    for out, (drive, response) in enumerate(zip(drives, responses, strict=True)):
        data, compressed = _compressed(_without(drives, out), _without(responses, out), method)
        low = (drive - data.input_offset) / data.input_scale
        high = (response - data.output_offset) / data.output_scale
        moved += float(np.sum((response - response.mean(axis=0)) ** 2))
        for order in range(1, MOST + 1):
            found = estimate(compressed, order, data.drives, data.responses, _TERMS)
            missed[order - 1] += _missed(found, low, high - found.constant, data.output_scale)
    fits = 100 * (1 - np.sqrt(missed / moved))
    return tuple(Candidate(order, float(fit[0]), float(fit[1]), HORIZON) for order, fit in enumerate(fits, start=1))


def identify(
    drives: Sequence[np.ndarray],
    responses: Sequence[np.ndarray],
    rate: float,
    order: int | None,
    method: Method,
) -> subspace.Identified:
    """Identify from all records, with the order given or the one that is proposed.

    Parameters
    ----------
    drives : sequence of arrays, each of shape (N, m), V or m
    responses : sequence of arrays, each of shape (N, p), m
    rate : float, samples/s
    order : int or None
    method : "n4sid" or "moesp"
    """
    candidates = tried(drives, responses, method)
    if order is None:
        _, compressed = _compressed(drives, responses, method)
        order = proposed(compressed.projection.singular_values, candidates)
    found = subspace.identify(drives, responses, rate, order=order, horizon=HORIZON, method=method, delay=0)
    return replace(found, candidates=candidates)


def _without(records: Sequence[np.ndarray], out: int) -> list[np.ndarray]:
    return [each for at, each in enumerate(records) if at != out]


def _compressed(
    drives: Sequence[np.ndarray], responses: Sequence[np.ndarray], method: Method
) -> tuple[Signals, Compressed]:
    data = signals(drives, responses, True)
    layout = Layout(HORIZON, HORIZON, drives[0].shape[1], responses[0].shape[1])
    return data, compress(Windows(data.joined, layout, 1, True), method)


def _missed(found: Estimate, drive: np.ndarray, response: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Return the sums of squares, m^2, that the free run and the prediction leave of a record."""
    model = found.model()
    free = response - model.simulate(drive, model.initial_state(drive, response))
    ahead = response - model.predict(drive, response, model.initial_predictor_state(drive, response))
    return np.array([np.sum((scale * free) ** 2), np.sum((scale * ahead) ** 2)])
