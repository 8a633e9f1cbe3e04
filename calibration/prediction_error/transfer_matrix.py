"""Transfer matrices with an order for each element, and noise of any colour, by the prediction error method."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from calibration.one_thread import on_one_thread
from calibration.prediction_error.pole_errors import ModeErrors, mode_errors, white_covariance
from calibration.prediction_error.scale import scale_of
from calibration.prediction_error.transfer_row import MOST_LAGS, Row, fit_row, plain_model
from calibration.records import as_records
from calibration.state_space.model import InnovationModel


@dataclass(frozen=True, eq=False)
class TransferMatrix:
    """A transfer matrix, element by element, and the state space of the whole.

    Parameters
    ----------
    numerators, denominators : tuples of tuples of arrays, shape (order + 1,), any unit
        Row (output) by row, in falling powers of z; the denominators begin with 1.  The quotient has the output's per
        the input's unit.
    errors : tuple of tuples of ModeErrors or None
        The modes of each element with their standard errors; None for an element of order 0.
    model : InnovationModel
        The elements' states row by row, then the noise's; the noise of each output has poles of its own.
    arrived : tuple of bool
        Whether the fit of each row ended at an optimum.
    """

    numerators: tuple[tuple[np.ndarray, ...], ...]
    denominators: tuple[tuple[np.ndarray, ...], ...]
    errors: tuple[tuple[ModeErrors | None, ...], ...]
    model: InnovationModel
    arrived: tuple[bool, ...]


@on_one_thread
def identify_transfer_matrix(
    drive: np.ndarray | Sequence[np.ndarray],
    response: np.ndarray | Sequence[np.ndarray],
    rate: float,
    orders: int | Sequence[Sequence[int]],
    *,
    direct: bool = False,
) -> TransferMatrix:
    """Fit y = G u + H e: every element of G a quotient of its own order, H diagonal, the inverse of a polynomial each.

    Each output is fitted by itself: an ARX model of high order, balanced and cut element by element, then Gauss-Newton
    on the free run with exact derivatives, then the same on signals filtered by the inverse of the noise's model (its
    order by BIC) until both belong together.  With that the residuals are white and the standard errors hold.  Every
    pole stays inside of the unit circle.

    Parameters
    ----------
    drive : array, shape (N, m), the inputs' units, or a sequence of such
        Deviations from the operating point.
    response : array, shape (N, p), the outputs' units, or a sequence of such
    rate : float, samples/s
    orders : int, or int per output and input, >= 0
        Poles of each element; with 0 an element is a gain where `direct`, else it is left out.
    direct : bool
        Whether inputs reach outputs within the sample.

    Source
    ------
    Sörnmo 2015, section 5.2 (transfer matrices of orders 2 to 6 by PEM); Ljung, System Identification, 2nd ed., 1999,
    eq. (4.31), Box and Jenkins' structure, with an autoregressive noise model.
    """
    drives, responses = as_records(drive, response)
    table = _orders(orders, responses[0].shape[1], drives[0].shape[1])
    scale = scale_of(drives, responses)
    drives, responses = scale.of_drives(drives), scale.of_responses(responses)
    rows = [fit_row(drives, [y[:, [number]] for y in responses], wanted, direct) for number, wanted in enumerate(table)]
    model = scale.removed(_realised(rows, rate, drives[0].shape[1]))
    parts = [_polynomials(row, model.D[number], scale.drive, scale.response[number]) for number, row in enumerate(rows)]
    errors = [mode_errors(row.found.coordinates, white_covariance(row.found), rate) for row in rows]
    return TransferMatrix(
        tuple(tuple(numerator for numerator, _ in row) for row in parts),
        tuple(tuple(denominator for _, denominator in row) for row in parts),
        tuple(_placed(each, row, model.inputs) for each, row in zip(errors, rows, strict=True)),
        model,
        tuple(row.found.arrived for row in rows),
    )


def _realised(rows: Sequence[Row], rate: float, inputs: int) -> InnovationModel:
    """Put elements and noises of all rows into one state space, in the fit's units."""
    plains = [plain_model(row.found.point.elements, row.found.point.direct, inputs) for row in rows]
    noises = [row.noise.model() for row in rows]
    order, quiet = sum(plain.order for plain in plains), sum(noise.order for noise in noises)
    shortest = min(len(row.residual) for row in rows)
    left = np.concatenate([row.residual[-shortest:] for row in rows], axis=1)
    return InnovationModel(
        np.asarray(block_diag(*(part.A for part in (*plains, *noises)))),
        np.concatenate([*(plain.B for plain in plains), np.zeros((quiet, inputs))]),
        np.concatenate([np.asarray(block_diag(*(part.C for part in parts))) for parts in (plains, noises)], axis=1),
        np.concatenate([plain.D for plain in plains]),
        np.concatenate([np.zeros((order, len(rows))), np.asarray(block_diag(*(noise.K for noise in noises)))]),
        rate,
        left.T @ left / shortest,
    )


def _polynomials(
    row: Row, direct: np.ndarray, drive: np.ndarray, response: float
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return numerator and denominator by input, in the measurement's units."""
    elements = dict(zip(row.inputs, row.found.point.elements, strict=True))
    found = []
    for number, gain in enumerate(direct):
        if number in elements:
            element = elements[number]
            denominator = np.poly(element.a).real
            rest = np.poly(element.a - element.b @ element.c).real - denominator
            found.append((rest * response / drive[number] + gain * denominator, denominator))
        else:
            found.append((np.array([gain]), np.ones(1)))
    return found


def _placed(errors: Sequence[ModeErrors], row: Row, inputs: int) -> tuple[ModeErrors | None, ...]:
    by_input = dict(zip(row.inputs, errors, strict=True))
    return tuple(by_input.get(number) for number in range(inputs))


def _orders(orders: int | Sequence[Sequence[int]], outputs: int, inputs: int) -> list[list[int]]:
    table = [[orders] * inputs] * outputs if isinstance(orders, int) else [list(row) for row in orders]
    if len(table) != outputs or any(len(row) != inputs for row in table):
        raise ValueError(f"orders are {orders}, must be one number or {outputs} rows of {inputs}")
    if not all(0 <= order <= MOST_LAGS // 2 for row in table for order in row):
        raise ValueError(f"orders are {orders}, must be 0 to {MOST_LAGS // 2}")
    if any(not any(row) for row in table):
        raise ValueError(f"orders are {orders}, must have an element of order >= 1 in every row")
    return table
