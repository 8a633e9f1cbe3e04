"""ARX models by least squares: many inputs and outputs, several records, orders chosen by AIC or BIC."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.linalg import qr, solve_triangular

from calibration.one_thread import on_one_thread
from calibration.records import as_records
from calibration.state_space.model import InnovationModel

CHUNK_ROWS = 4096
"""Samples folded into the triangle at a time: what bounds the memory."""

NEGLIGIBLE = 1e-10
"""Diagonal of the triangle, relative to its column, below which a regressor depends on those before it."""


@dataclass(frozen=True, eq=False)
class Arx:
    """An ARX model: y[k] = sum over l of a[l-1] y[k-l], plus sum over l of b[l] u[k-l], plus e[k].

    Parameters
    ----------
    a : array, shape (na, p, p), the outputs' units
    b : array, shape (1 + nb, p, m), the outputs' per the inputs' units
        From lag 0 on; zero up to each input's delay.
    covariance : array, shape (p, p), products of the outputs' units
        Of the residuals.
    rate : float, samples/s
    lags : array, shape (candidates,), 1
        Orders looked at; one where it was given.
    criterion : array, shape (candidates,), 1
        Of each, per sample; least for the order taken.
    """

    a: np.ndarray
    b: np.ndarray
    covariance: np.ndarray
    rate: float
    lags: np.ndarray
    criterion: np.ndarray

    def model(self) -> InnovationModel:
        """Return it as a state space in observer form, with p states a lag."""
        outputs, count = self.b.shape[1], max(len(self.a), len(self.b) - 1)
        a = np.zeros((count, outputs, outputs))
        b = np.zeros((count + 1, *self.b.shape[1:]))
        a[: len(self.a)], b[: len(self.b)] = self.a, self.b
        gain = a.reshape(count * outputs, outputs)
        transition = np.eye(count * outputs, k=outputs)
        transition[:, :outputs] += gain
        inlet = b[1:].reshape(count * outputs, -1) + gain @ b[0]
        outlet = np.eye(outputs, count * outputs)
        return InnovationModel(transition, inlet, outlet, b[0], gain, self.rate, self.covariance)


@on_one_thread
def arx(
    drive: np.ndarray | Sequence[np.ndarray],
    response: np.ndarray | Sequence[np.ndarray],
    rate: float,
    lags: int | tuple[int, int],
    *,
    delays: int | Sequence[int] = 1,
    choose: Literal["aic", "bic"] | None = None,
) -> Arx:
    """Fit an ARX model by least squares, through a QR factorisation folded over the records.

    Parameters
    ----------
    drive : array, shape (N, m), the inputs' units, or a sequence of such
    response : array, shape (N, p), the outputs' units, or a sequence of such
        As many records as drives.
    rate : float, samples/s
    lags : int or (int, int)
        How many of the outputs before, and how many of each input from its delay on.
    delays : int or sequence of int, one an input, >= 0
        Samples from an input to the first output it can move; 0: within the sample.
    choose : "aic" or "bic", optional
        Take that order from 1 to `lags` which has the least criterion; all are fitted to the same samples.

    Source
    ------
    Ljung, System Identification, 2nd ed., 1999, sections 4.2, 10.1 and 16.4.
    """
    drives, responses = as_records(drive, response)
    inputs, outputs = drives[0].shape[1], responses[0].shape[1]
    past, held = (lags, lags) if isinstance(lags, int) else lags
    waits = [delays] * inputs if isinstance(delays, int) else list(delays)
    if not (past >= 0 and held >= 0 and past + held > 0):
        raise ValueError(f"lags are {lags}, must be >= 0, one of them > 0")
    if len(waits) != inputs or not all(wait >= 0 for wait in waits):
        raise ValueError(f"delays are {delays}, must be one or {inputs}, >= 0")
    if choose is not None and past != held and min(past, held) > 0:
        raise ValueError(f"lags are {lags}, must be alike or one of them 0 to choose from up to it")
    table = _regressors(past, held, waits, outputs)
    triangle, count = _folded(drives, responses, table)
    columns = len(table)
    if count <= columns + outputs:
        raise ValueError(f"{count} samples with a whole past, must be more than {columns + outputs} for lags {lags}")
    found, criterion = np.array([max(past, held)]), np.zeros(1)
    if choose is not None:
        step = columns // max(past, held)
        found, criterion = _criteria(triangle, count, max(past, held), step, outputs, choose)
        columns = int(found[np.argmin(criterion)]) * step
    right, rest = np.split(triangle[:, len(table) :], [columns])
    weights = _solved(triangle[:columns, :columns], right)
    a, b = _coefficients(table[:columns], weights, inputs, outputs)
    return Arx(a, b, rest.T @ rest / (count - columns), rate, found, criterion)


def _regressors(past: int, held: int, waits: Sequence[int], outputs: int) -> list[tuple[int, int]]:
    """List channel and lag of each regressor, by rising order; outputs are channels 0 to p - 1, inputs follow."""
    table = []
    for lag in range(max(past, held)):
        table += [(channel, lag + 1) for channel in range(outputs) if lag < past]
        table += [(outputs + channel, wait + lag) for channel, wait in enumerate(waits) if lag < held]
    return table


def _folded(
    drives: Sequence[np.ndarray], responses: Sequence[np.ndarray], table: list[tuple[int, int]]
) -> tuple[np.ndarray, int]:
    """Return the triangle of regressors and outputs, and how many samples are in it."""
    triangle, count = np.zeros((0, len(table) + responses[0].shape[1])), 0
    for rows in _rows(drives, responses, table):
        triangle = qr(np.concatenate([triangle, rows]), mode="r", overwrite_a=True, check_finite=False)[0]
        triangle = triangle[: triangle.shape[1]]
        count += len(rows)
    return triangle, count


def _rows(
    drives: Sequence[np.ndarray], responses: Sequence[np.ndarray], table: list[tuple[int, int]]
) -> Iterator[np.ndarray]:
    outputs, longest = responses[0].shape[1], max(lag for _, lag in table)
    for u, y in zip(drives, responses, strict=True):
        for start in range(longest, len(y), CHUNK_ROWS):
            end = min(start + CHUNK_ROWS, len(y))
            rows = np.empty((end - start, len(table) + outputs))
            for column, (channel, lag) in enumerate(table):
                source = y[:, channel] if channel < outputs else u[:, channel - outputs]
                rows[:, column] = source[start - lag : end - lag]
            rows[:, len(table) :] = y[start:end]
            yield rows


def _criteria(
    triangle: np.ndarray, count: int, most: int, step: int, outputs: int, kind: str
) -> tuple[np.ndarray, np.ndarray]:
    """Return the orders 1 to `most` and the criterion of each, from one triangle: its columns rise with the order."""
    orders = np.arange(1, most + 1)
    price = 2.0 if kind == "aic" else np.log(count)
    values = []
    for order in orders:
        rest = triangle[order * step :, most * step :]
        value = np.linalg.slogdet(rest.T @ rest / count)[1]
        values.append(value + price * order * step * outputs / count)
    return orders, np.array(values)


def _solved(triangle: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solve, leaving out regressors that depend on those before them."""
    sizes = np.linalg.norm(triangle, axis=0)
    kept = np.abs(np.diag(triangle)) > NEGLIGIBLE * sizes
    weights = np.zeros((len(triangle), right.shape[1]))
    if kept.all():
        weights[:] = solve_triangular(triangle, right)
    else:
        weights[kept] = np.linalg.lstsq(triangle[:, kept], right, rcond=None)[0]
    return weights


def _coefficients(
    table: Sequence[tuple[int, int]], weights: np.ndarray, inputs: int, outputs: int
) -> tuple[np.ndarray, np.ndarray]:
    past = max((lag for channel, lag in table if channel < outputs), default=0)
    held = max((lag for channel, lag in table if channel >= outputs), default=0)
    a, b = np.zeros((past, outputs, outputs)), np.zeros((held + 1, outputs, inputs))
    for (channel, lag), row in zip(table, weights, strict=True):
        if channel < outputs:
            a[lag - 1, :, channel] = row
        else:
            b[lag, :, channel - outputs] = row
    return a, b
