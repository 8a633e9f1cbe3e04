"""Residuals of a parallel form over records, and the normal equations of a step in its coordinates."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from calibration.prediction_error import parallel_kernel
from calibration.prediction_error.parallel_form import ParallelForm

CHUNK = 250_000
"""Numbers of the Jacobian held at a time: what makes memory independent of the records' length."""

LEAST_FRAMES = 64

BATCHES = 16
"""Into how many parts all records together are cut to see how the gradient scatters."""

LEAST_SCALE = 1e-6
"""Information of a parameter, relative to the greatest, that damping takes it to have at least."""

NEGLIGIBLE = 1e-12
"""Information, relative to the greatest, below which a part of an initial state is left as it is."""


@dataclass(frozen=True, eq=False)
class Record:
    """A stretch of measurement.

    Parameters
    ----------
    signals : array, shape (N, inputs), any unit
        What drives the form.
    target : array, shape (N, outputs), any unit
        What it is to give.
    """

    signals: np.ndarray
    target: np.ndarray


@dataclass(frozen=True, eq=False)
class Normal:
    """Normal equations of the free parameters, every record's initial state eliminated.

    Parameters
    ----------
    information : array, shape (free, free), any unit
        Gauss-Newton Hessian.
    slope : array, shape (free,), any unit
        Negative gradient.
    cross, inverse, state_slope : tuples of arrays, shapes (free, n), (n, n) and (n,), any unit
        A record's state with the parameters; the inverse of its own information; its negative gradient.
    """

    information: np.ndarray
    slope: np.ndarray
    cross: tuple[np.ndarray, ...]
    inverse: tuple[np.ndarray, ...]
    state_slope: tuple[np.ndarray, ...]

    def step(self, damping: float, room: np.ndarray, approach: np.ndarray) -> np.ndarray:
        """Return the damped step, shape (free,), that keeps approach @ step <= room.

        Parameters
        ----------
        damping : float, relative to the information of each parameter
        room : array, shape (fences,), 1
        approach : array, shape (fences, free), any unit
        """
        own = np.diag(self.information)
        scale = np.sqrt(own.clip(LEAST_SCALE * max(own.max(), np.finfo(float).tiny)))
        scaled = self.information / np.outer(scale, scale) + damping * np.eye(len(scale))
        rows = approach / scale
        solved = np.linalg.lstsq(scaled, np.column_stack([self.slope / scale, rows.T]), rcond=1e-14)[0]
        plain, bent = solved[:, 0], solved[:, 1:]
        step, active = plain, np.zeros(len(room), bool)
        while (over := np.where(active, 0.0, rows @ step - room)).max(initial=0.0) > 0:
            active[np.argmax(over)] = True
            pull = rows[active] @ bent[:, active]
            step = plain - bent[:, active] @ np.linalg.lstsq(pull, rows[active] @ plain - room[active], rcond=None)[0]
        found: np.ndarray = step / scale
        return found

    def state_steps(self, step: np.ndarray) -> list[np.ndarray]:
        """Return the step of each record's initial state, shape (n,), that goes with a step of the parameters.

        Parameters
        ----------
        step : array, shape (free,), any unit
        """
        parts = zip(self.cross, self.inverse, self.state_slope, strict=True)
        return [inverse @ (slope - cross.T @ step) for cross, inverse, slope in parts]

    def gain(self, step: np.ndarray) -> float:
        """Return by how much a step lowers the criterion, if that were quadratic, in squares of standard errors.

        Parameters
        ----------
        step : array, shape (free,), any unit
        """
        return float(2 * self.slope @ step - step @ self.information @ step)


def normal_equations(
    form: ParallelForm, slopes: np.ndarray, records: Sequence[Record], states: Sequence[np.ndarray], weight: np.ndarray
) -> Normal:
    """Sum the normal equations over records.

    Parameters
    ----------
    form : ParallelForm
    slopes : array, shape (parameters, free), any unit
        How the form's numbers follow the free parameters.
    records : sequence of Record
    states : sequence of arrays, shape (n,), 1
    weight : array, shape (outputs, outputs), 1 per the targets' units
        Residuals are multiplied by it.
    """
    free, count = slopes.shape[1], form.sections.parameters
    information, slope = np.zeros((free, free)), np.zeros(free)
    crosses, inverses, state_slopes = [], [], []
    for record, state in zip(records, states, strict=True):
        gram, moment = _accumulated(form, record, state, weight)
        cross, inverse = slopes.T @ gram[:count, count:], _pseudo_inverse(gram[count:, count:])
        information += slopes.T @ gram[:count, :count] @ slopes - cross @ inverse @ cross.T
        slope += slopes.T @ moment[:count] - cross @ (inverse @ moment[count:])
        crosses.append(cross)
        inverses.append(inverse)
        state_slopes.append(moment[count:])
    return Normal(information, slope, tuple(crosses), tuple(inverses), tuple(state_slopes))


def score_covariance(
    form: ParallelForm,
    slopes: np.ndarray,
    records: Sequence[Record],
    states: Sequence[np.ndarray],
    weight: np.ndarray,
    normal: Normal,
) -> np.ndarray:
    """Return the covariance of the criterion's gradient, shape (free, free), whatever the spectrum of the residuals.

    Each record is cut into batches, far longer than the residuals' memory if there is enough of it; a batch's gradient
    is a sample of that covariance.

    Parameters
    ----------
    form : ParallelForm
    slopes : array, shape (parameters, free), any unit
    records : sequence of Record
    states : sequence of arrays, shape (n,), 1
    weight : array, shape (outputs, outputs), 1 per the targets' units
    normal : Normal
        Of the same form, records and states.
    """
    count, total = form.sections.parameters, np.zeros((slopes.shape[1],) * 2)
    longest = max(1, sum(len(record.target) for record in records) // BATCHES)
    for record, state, cross, inverse in zip(records, states, normal.cross, normal.inverse, strict=True):
        misfit, start = residual(form, record, state) @ weight.T, 0
        for here in _derivatives(form, record, state, longest):
            moment = np.einsum("kof,ko->f", np.matmul(weight, here), misfit[start : start + len(here)])
            score = slopes.T @ moment[:count] - cross @ (inverse @ moment[count:])
            total += np.outer(score, score)
            start += len(here)
    return total


def residual_covariance(form: ParallelForm, records: Sequence[Record], states: Sequence[np.ndarray]) -> np.ndarray:
    """Return the residuals' second moments over all records, shape (outputs, outputs).

    Parameters
    ----------
    form : ParallelForm
    records : sequence of Record
    states : sequence of arrays, shape (n,), 1
    """
    parts = [residual(form, record, state) for record, state in zip(records, states, strict=True)]
    with np.errstate(over="ignore", invalid="ignore"):
        total: np.ndarray = np.sum([part.T @ part for part in parts], axis=0)
    return total / sum(len(part) for part in parts)


def residual(form: ParallelForm, record: Record, state: np.ndarray) -> np.ndarray:
    """Return what the form does not give of the target, shape (N, outputs).

    Parameters
    ----------
    form : ParallelForm
    record : Record
    state : array, shape (n,), 1
    """
    response = np.empty_like(record.target)
    table = form.sections.table
    parallel_kernel.respond(table, form.coupling, form.values, form.direct, state.copy(), record.signals, response)
    found: np.ndarray = record.target - response
    return found


def _accumulated(
    form: ParallelForm, record: Record, state: np.ndarray, weight: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Sum J'J and J'e of the weighted residuals, the derivatives by the initial state behind the others."""
    columns = form.sections.parameters + form.sections.order
    gram, moment = np.zeros((columns, columns)), np.zeros(columns)
    misfit = residual(form, record, state) @ weight.T
    start = 0
    frames = max(LEAST_FRAMES, CHUNK // (columns * form.sections.outputs))
    for here in _derivatives(form, record, state, frames):
        weighted = (weight[0, 0] * here if len(weight) == 1 else np.matmul(weight, here)).reshape(-1, columns)
        gram += weighted.T @ weighted
        moment += weighted.T @ misfit[start : start + len(here)].ravel()
        start += len(here)
    return gram, moment


def _derivatives(form: ParallelForm, record: Record, state: np.ndarray, frames: int) -> Iterator[np.ndarray]:
    """Yield the response's derivatives chunk by chunk, shape (frames, outputs, parameters + n), in one array."""
    sections, running = form.sections, state.copy()
    columns = sections.parameters + sections.order
    jacobian = np.zeros((min(frames, len(record.target)), sections.outputs, columns))
    widths = [last - first for first, last in zip(sections.firsts, sections.lasts, strict=True)]
    filters = np.zeros((len(widths), 3 + max(widths, default=0), 2))
    filters[np.arange(len(widths)), 2, np.array(sections.sizes, int) - 1] = 1.0
    for start in range(0, len(record.target), frames):
        signals = record.signals[start : start + frames]
        here = jacobian[: len(signals)]
        parallel_kernel.differentiate(sections.table, form.coupling, form.values, running, filters, signals, here)
        for output in range(sections.outputs):
            first = sections.direct_at + output * sections.direct
            here[:, output, first : first + sections.direct] = signals[:, : sections.direct]
        yield here


def _pseudo_inverse(gram: np.ndarray) -> np.ndarray:
    values, vectors = np.linalg.eigh(gram)
    kept = values > NEGLIGIBLE * max(values.max(initial=0.0), np.finfo(float).tiny)
    inverse: np.ndarray = (vectors[:, kept] / values[kept]) @ vectors[:, kept].T
    return inverse
