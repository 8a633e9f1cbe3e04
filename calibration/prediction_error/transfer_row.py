"""One output of a transfer matrix: an element for each input, and noise of any colour."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from calibration.prediction_error.autoregression import Arx, arx
from calibration.prediction_error.element import LARGEST_MODULUS, Element, balanced
from calibration.prediction_error.gauss_newton import Effort, Fit, fit
from calibration.prediction_error.local_coordinates import free
from calibration.prediction_error.normal_equations import Record, residual
from calibration.state_space.model import InnovationModel

MOST_LAGS = 40
"""Of the ARX model that a fit starts from, and of the noise."""

PASSES = 3
"""How often the noise is modelled and the response is fitted again through its inverse."""

ITERATIONS = 100


@dataclass(frozen=True, eq=False)
class Row:
    """One output, fitted.

    Parameters
    ----------
    found : Fit
        Of the elements that have an order, on signals filtered by the noise's inverse.
    inputs : tuple of int
        Which input drives each element.
    noise : Arx
    residual : array, shape (N, 1), any unit
        Innovations of all records.
    """

    found: Fit
    inputs: tuple[int, ...]
    noise: Arx
    residual: np.ndarray


def fit_row(drives: Sequence[np.ndarray], responses: Sequence[np.ndarray], orders: Sequence[int], direct: bool) -> Row:
    """Fit one output to all drives.

    Parameters
    ----------
    drives : sequence of arrays, shape (N, m), any unit
    responses : sequence of arrays, shape (N, 1), any unit
    orders : sequence of int, one an input
        Poles of each element, some of them > 0.
    direct : bool
        Whether inputs reach the output within the sample.
    """
    used = tuple(number for number, order in enumerate(orders) if order)
    raw = [Record(u, y) for u, y in zip(drives, responses, strict=True)]
    starts = [_start(drives, responses, orders, choose, 0 if direct else 1) for choose in (True, False)]
    found = min((_fitted(start, through, raw) for start, through in starts), key=lambda each: each.point.cost)
    for _ in range(PASSES):
        plain = plain_model(found.point.elements, found.point.direct, len(orders))
        left = [y - plain.simulate(u, plain.initial_state(u, y)) for u, y in zip(drives, responses, strict=True)]
        noise = arx(
            [np.zeros_like(part) for part in left], left, 1.0, (min(MOST_LAGS, len(left[0]) // 10), 0), choose="bic"
        )
        inverse = np.concatenate([[1.0], -noise.a[:, 0, 0]])
        records = [Record(*(_through(inverse, signals) for signals in (r.signals, r.target))) for r in raw]
        found = _fitted(found.point.elements, found.point.direct, records)
    pairs = zip(records, found.states, strict=True)
    white = np.concatenate([residual(found.coordinates.form, record, state) for record, state in pairs])
    return Row(found, used, noise, white)


def plain_model(elements: Sequence[Element], direct: np.ndarray, inputs: int) -> InnovationModel:
    """Return the elements of one output as a state space without noise, in the fit's units, one sample a second.

    Parameters
    ----------
    elements : sequence of Element
        One an input of order > 0.
    direct : array, shape (1, inputs) or (1, 0), any unit
    inputs : int
    """
    order, at = sum(len(element.a) for element in elements), 0
    b = np.zeros((order, inputs))
    for element in elements:
        b[at : (at := at + len(element.a)), element.first] = element.b[:, 0]
    return InnovationModel(
        np.asarray(block_diag(*(element.a for element in elements))),
        b,
        np.concatenate([element.c for element in elements], axis=1),
        direct if direct.size else np.zeros((1, inputs)),
        np.zeros((order, 1)),
        1.0,
        np.eye(1),
    )


def _through(taps: np.ndarray, signals: np.ndarray) -> np.ndarray:
    """Return columns filtered by a finite response, from the sample on that all of it has heard."""
    return np.stack([np.convolve(column, taps, "valid") for column in signals.T], axis=1)


def _fitted(elements: Sequence[Element], direct: np.ndarray, records: Sequence[Record]) -> Fit:
    return fit(elements, direct, records, free, joint=True, effort=Effort(ITERATIONS))


def _start(
    drives: Sequence[np.ndarray], responses: Sequence[np.ndarray], orders: Sequence[int], choose: bool, delay: int
) -> tuple[list[Element], np.ndarray]:
    """Cut an ARX model of one output, or a finite response where that is unstable, to elements of the wanted orders.

    Returned with them is the direct path, shape (1, inputs), or (1, 0) where there is a delay.
    """
    most = min(MOST_LAGS, len(responses[0]) // (3 * (len(orders) + 1)))
    whole = arx(drives, responses, 1.0, most, delays=delay, choose="bic" if choose else None).model()
    if not np.abs(whole.poles).max() <= LARGEST_MODULUS or whole.order < max(orders):
        whole = arx(drives, responses, 1.0, (0, most), delays=delay).model()
    elements = []
    for number, order in enumerate(orders):
        if order:
            even, _ = balanced(Element(whole.A, whole.B[:, [number]], whole.C))
            elements.append(Element(even.a[:order, :order], even.b[:order], even.c[:, :order], number))
    return elements, whole.D if delay == 0 else whole.D[:, :0]
