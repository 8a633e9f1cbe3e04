"""Identification in the frequency domain: an order, a realization, and a refinement of it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from calibration.frequency_domain.modal_form import ModalForm
from calibration.frequency_domain.realization import Subspace, realized, subspace_of
from calibration.frequency_domain.refinement import Refined, cost_of, refine
from calibration.frequency_domain.response_model import ResponseModel, covariance_of, points_of
from calibration.one_thread import on_one_thread
from calibration.subspace import asked

MOST, GRID = 120, 24
"""States that are tried at most, and how many orders up to there."""
SPARE = 2.0
"""Block rows, re the least that tell the largest order."""
BRIEF, FINALISTS = 15, 6
"""Steps of refinement, and the orders that get them, before one is chosen."""
TRIES, HEAVY = 3, 0.7
"""Modes that are left out, each by itself, before it is taken that all are wanted; damping ratio of a pair that may be
one real pole."""
FEWEST = 8
"""Lines."""
FAINT = 1e-4
"""Least standard error, re the largest response: nothing is known better."""

Measured = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Frequencies, shape (bins,), Hz; response and variance, shapes (bins, outputs, inputs)."""


def merged(parts: Sequence[Measured]) -> Measured:
    """Put records and bands of one response together; a line may be in several, each with its own variance.

    Parameters
    ----------
    parts : sequence of (frequency, response, variance)
        Shapes (bins,), Hz, and (bins, outputs, inputs).
    """
    frequency, response, variance = (np.concatenate([each[at] for each in parts]) for at in range(3))
    rising = np.argsort(frequency, kind="stable")
    return frequency[rising], response[rising], variance[rising]


@on_one_thread
def identify_response(
    frequency: np.ndarray,
    response: np.ndarray,
    variance: np.ndarray | None = None,
    *,
    rate: float | None = None,
    order: int | None = None,
    most: int = MOST,
    direct: bool = True,
) -> ResponseModel:
    """Identify a stable state-space model from a frequency response.

    By a subspace method on the imaginary axis, whose poles, shapes, B and D are then moved until the weighted error is
    least.  Without an order, those that do best by a subspace alone are refined, and of the one with the least Bayesian
    information criterion modes are left out as long as that gets less.

    Parameters
    ----------
    frequency : array, shape (bins,), Hz, > 0
        Rising; lines may be given more than once.
    response : complex array, shape (bins, outputs, inputs) or (bins,), any unit
    variance : array, shape (bins, outputs, inputs) or (bins,), the response's unit squared, optional
        E |error|^2 of each element; without it all are alike.
    rate : float, optional, samples/s
        Of a model in discrete time; without it the model is continuous.
    order : int, optional
    most : int, optional
        Largest order that is tried.
    direct : bool, optional
        Whether there is a D; else it is 0.

    Raises
    ------
    ValueError : shapes that disagree, values that are not finite, lines beyond half the rate, too few lines, a rate or
        an order that is none.

    Source
    ------
    McKelvey, Akçay and Ljung 1996, IEEE Trans. Automatic Control 41, 960-979; Pintelon and Schoukens 2012, System
    Identification, 2nd ed., section 9 (weighted least squares); Schwarz 1978, Ann. Stat. 6, 461-464.
    """
    if rate is not None:
        asked.check_rate(rate)
    order, most = asked.order_of(order), asked.order_of(most, "most") or MOST
    data = _prepared(frequency, response, variance, rate)
    most = min(most, data.largest_order)
    if order is not None and not 1 <= order <= data.largest_order:
        raise ValueError(f"order is {order}, must be 1 to {data.largest_order} for {len(data.points)} bins")
    if order is None:
        start = _chosen(data, most, direct)
    else:
        start = realized(data.subspace(data.rows(order)), order, *data.parts, direct)
    done = refine(start, *data.parts, direct)
    form, free = done.form, 2 * data.response.size - _freedom(done.form, direct)
    spread = float(np.sqrt(2 * done.cost / max(1, free)))
    covariance = covariance_of(2 * done.normal, spread if variance is None else max(1.0, spread))
    unit = np.ones(len(form.numbers))
    unit[-form.C.size - form.D.size :] = data.size
    return ResponseModel(
        replace(form, C=data.size * form.C, D=data.size * form.D),
        data.scale,
        rate,
        unit[:, np.newaxis] * covariance * unit,
        spread,
        (float(frequency[0]), float(frequency[-1])),
    )


@dataclass(frozen=True, eq=False)
class _Data:
    """A response in units of `size`, at points in units of `scale`, rad/s."""

    points: np.ndarray
    response: np.ndarray
    sigma: np.ndarray
    scale: float
    size: float

    @property
    def parts(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return self.points, self.response, self.sigma

    @property
    def most_rows(self) -> int:
        """Block rows of which there are no more than columns."""
        _, p, m = self.response.shape
        return max(2, int(2 * len(self.points) * m // (p + m)))

    @property
    def largest_order(self) -> int:
        """States that block rows can tell, and for which there are numbers enough."""
        count, p, m = self.response.shape
        told, enough = p * (self.most_rows - 1), (2 * count * p * m - p * m) // (2 * (p + m))
        return max(1, int(min(told, enough)))

    def rows(self, order: int) -> int:
        """Return how many block rows are enough for an order, of those that there can be."""
        return min(int(SPARE * np.ceil(order / self.response.shape[1])) + 2, self.most_rows)

    def subspace(self, rows: int) -> Subspace:
        """Return what so many block rows tell of all orders that they are enough for."""
        return subspace_of(self.points, self.response, 1.0 / self.sigma.mean(axis=(1, 2)), rows)


def _prepared(frequency: np.ndarray, response: np.ndarray, variance: np.ndarray | None, rate: float | None) -> _Data:
    """Refuse what cannot be fitted; scale the rest."""
    if np.iscomplexobj(frequency):
        raise ValueError("frequency is complex, must be real, in Hz: it is given before the response")
    if not np.iscomplexobj(response):
        raise ValueError("response is real, must be complex: a magnitude without its phase is no response")
    lines, given = np.asarray(frequency, float), np.asarray(response, complex)
    given = given.reshape(-1, 1, 1) if given.ndim == 1 else given
    if given.ndim != 3 or lines.shape != given.shape[:1]:
        raise ValueError(
            f"response has shape {given.shape} over {lines.shape} frequencies, must be (bins, outputs, inputs)"
        )
    if len(lines) < FEWEST:
        raise ValueError(f"there are {len(lines)} bins, must be {FEWEST} or more")
    if not (np.isfinite(lines).all() and lines[0] > 0 and np.all(np.diff(lines) >= 0)):
        raise ValueError("frequencies must be finite, > 0 Hz and rising")
    if rate is not None and not lines[-1] < rate / 2:
        raise ValueError(f"frequency goes to {lines[-1]:g} Hz, must be below half the rate, {rate / 2:g} Hz")
    if not np.isfinite(given).all():
        raise ValueError(f"response is not finite at {lines[np.argwhere(~np.isfinite(given))[0][0]]:g} Hz")
    size = float(np.sqrt(np.mean(np.abs(given) ** 2)))
    if size == 0.0:
        raise ValueError("response is 0 at all bins: there is nothing to identify")
    sigma = np.ones(given.shape)
    if variance is not None:
        spread = np.asarray(variance, float).reshape(given.shape)
        if not (np.isfinite(spread).all() and (spread >= 0).all()):
            raise ValueError("variance must be finite and >= 0 everywhere")
        sigma = np.maximum(np.sqrt(spread) / size, FAINT * np.abs(given).max() / size)
    scale = 2 * np.pi * float(np.sqrt(lines[0] * lines[-1]))
    if rate is not None:
        scale = float(np.abs(points_of(lines[[0, -1]], 1.0, rate)).prod() ** 0.5)
    return _Data(points_of(lines, scale, rate), given / size, sigma, scale, size)


def _chosen(data: _Data, most: int, is_direct: bool) -> ModalForm:
    """Return a system of the order with the least criterion, briefly refined.

    Many block rows tell modes apart that are near each other, but where they are as many as the bins allow they tell
    nothing; so each order is tried by as many as it needs, by twice as many, and by those of the largest.
    """
    subspace = cache(data.subspace)  # the widest is that of many orders
    rough, widest = [], subspace(data.rows(most))
    largest = min(most, widest.observability.shape[0] - widest.outputs)
    for order in np.unique(np.geomspace(1, largest, GRID).round().astype(int)).tolist():
        for rows in sorted({data.rows(each) for each in (order, 2 * order, most)}):
            form = realized(subspace(rows), order, *data.parts, is_direct)
            rough.append((_criterion(form, cost_of(form, *data.parts), data, is_direct), form))
    finalists = sorted(rough, key=lambda each: each[0])[:FINALISTS]
    done = [refine(form, *data.parts, is_direct, BRIEF) for _, form in finalists]
    best = min(done, key=lambda each: _criterion(each.form, each.cost, data, is_direct))
    return _pruned(best, data, is_direct).form


def _pruned(best: Refined, data: _Data, is_direct: bool) -> Refined:
    """Leave out modes, the least first, as long as the criterion gets less: states that a subspace alone needs."""
    least = _criterion(best.form, best.cost, data, is_direct)
    while True:
        for smaller in _smaller(best.form, data):
            trial = refine(smaller, *data.parts, is_direct, BRIEF)
            criterion = _criterion(trial.form, trial.cost, data, is_direct)
            if criterion < least:
                best, least = trial, criterion
                break
        else:
            return best


def _smaller(form: ModalForm, data: _Data) -> Iterator[ModalForm]:
    """Give forms of fewer states to be tried: pairs that do not ring as one pole, then each of the least modes gone."""
    pairs = len(form.turn)
    damping = form.decay[:pairs] / np.hypot(form.decay[:pairs], form.turn)
    for pair in np.flatnonzero(damping > HEAVY):
        yield form.with_single(int(pair))
    if len(form.decay) > 1:
        for mode in np.argsort(form.sizes(data.points, data.sigma))[:TRIES]:
            yield form.without(int(mode))


def _criterion(form: ModalForm, cost: float, data: _Data, is_direct: bool) -> float:
    """Return Schwarz' criterion, with the errors' size unknown, for variances are rarely all that is left."""
    count = 2 * data.response.size
    return float(count * np.log(cost / count) + _freedom(form, is_direct) * np.log(count))


def _freedom(form: ModalForm, is_direct: bool) -> int:
    """Return how many numbers a response tells of a form: those of a minimal realization."""
    (p, m), n = form.D.shape, form.order
    return int(n * (p + m) + p * m * is_direct)
