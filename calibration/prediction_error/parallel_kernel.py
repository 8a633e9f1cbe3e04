"""Kernels of a parallel form: its response, and the derivatives of it by every parameter, sample by sample."""

import numpy as np

from rigkit.compiled import njit
from rigkit.flush_kernel import flushed

_SIGMA, _BEND, _START, _INPUTS = 0, 1, 2, 3
"""Filters of a section: by its centre, by its bend, by its initial state, and one an input."""


@njit(cache=True, nogil=True)
def respond(
    sections: np.ndarray,
    coupling: np.ndarray,
    values: np.ndarray,
    direct: np.ndarray,
    state: np.ndarray,
    signals: np.ndarray,
    response: np.ndarray,
) -> None:
    """Fill the response, shape (N, p), and leave the state, shape (n,), as it is after the last sample.

    A row of `sections` is size, first state, first and last input, first parameter; the h of each
    is `coupling`; `values` are the parameters in the order of `ParallelForm`; `direct` has shape (p, inputs).
    """
    outputs = response.shape[1]
    for k in range(len(signals)):
        for o in range(outputs):
            total = 0.0
            for j in range(direct.shape[1]):
                total += direct[o, j] * signals[k, j]
            response[k, o] = total
        for b in range(len(sections)):
            size, at, first, last, p = sections[b]
            width = last - first
            if size == 1:
                x1 = state[at]
                c = p + 1 + width
                for o in range(outputs):
                    response[k, o] += values[c + o] * x1
                driven = 0.0
                for i in range(width):
                    driven += values[p + 1 + i] * signals[k, first + i]
                state[at] = flushed(values[p] * x1 + driven)
            else:
                x1, x2 = state[at], state[at + 1]
                c = p + 2 + 2 * width
                for o in range(outputs):
                    response[k, o] += values[c + 2 * o] * x1 + values[c + 2 * o + 1] * x2
                driven, driven2 = 0.0, 0.0
                for i in range(width):
                    driven += values[p + 2 + 2 * i] * signals[k, first + i]
                    driven2 += values[p + 3 + 2 * i] * signals[k, first + i]
                state[at] = flushed(values[p] * x1 + coupling[b] * x2 + driven)
                state[at + 1] = flushed(values[p] * x2 - values[p + 1] * x1 + driven2)


@njit(cache=True, nogil=True)
def differentiate(
    sections: np.ndarray,
    coupling: np.ndarray,
    values: np.ndarray,
    state: np.ndarray,
    filters: np.ndarray,
    signals: np.ndarray,
    jacobian: np.ndarray,
) -> None:
    """Fill the derivatives of the response, shape (N, p, parameters + n), the initial state's behind the parameters'.

    `state` and `filters`, shape (sections, 3 + inputs, 2), go on from one call to the next.  What an output does not
    depend on stays as it is, zero: an output's row of C and D in the derivatives of the others.
    """
    for k in range(len(signals)):
        for b in range(len(sections)):
            if sections[b, 0] == 1:
                _first_order(sections[b], values, state, filters[b], signals[k], jacobian[k])
            else:
                _second_order(sections[b], coupling[b], values, state, filters[b], signals[k], jacobian[k])


@njit(cache=True, nogil=True, inline="always")
def _first_order(
    section: np.ndarray,
    values: np.ndarray,
    state: np.ndarray,
    filters: np.ndarray,
    signal: np.ndarray,
    jacobian: np.ndarray,
) -> None:
    _, at, first, last, p = section
    outputs, behind = jacobian.shape[0], len(values)
    width = last - first
    pole, x = values[p], state[at]
    c = p + 1 + width
    for o in range(outputs):
        out = values[c + o]
        jacobian[o, p] = out * filters[_SIGMA, 0]
        for i in range(width):
            jacobian[o, p + 1 + i] = out * filters[_INPUTS + i, 0]
        jacobian[o, c + o] = x
        jacobian[o, behind + at] = out * filters[_START, 0]
    driven = 0.0
    for i in range(width):
        s = signal[first + i]
        driven += values[p + 1 + i] * s
        filters[_INPUTS + i, 0] = flushed(pole * filters[_INPUTS + i, 0] + s)
    filters[_SIGMA, 0] = flushed(pole * filters[_SIGMA, 0] + x)
    filters[_START, 0] = flushed(pole * filters[_START, 0])
    state[at] = flushed(pole * x + driven)


@njit(cache=True, nogil=True, inline="always")
def _second_order(
    section: np.ndarray,
    coupling: float,
    values: np.ndarray,
    state: np.ndarray,
    filters: np.ndarray,
    signal: np.ndarray,
    jacobian: np.ndarray,
) -> None:
    _, at, first, last, p = section
    outputs, behind = jacobian.shape[0], len(values)
    width = last - first
    bend = values[p + 1]
    x1, x2 = state[at], state[at + 1]
    c = p + 2 + 2 * width
    ratio = bend / coupling
    for o in range(outputs):
        out1, out2 = values[c + 2 * o], values[c + 2 * o + 1]
        jacobian[o, p] = out1 * filters[_SIGMA, 0] + out2 * filters[_SIGMA, 1]
        jacobian[o, p + 1] = out1 * filters[_BEND, 0] + out2 * filters[_BEND, 1]
        for i in range(width):
            f1, f2 = filters[_INPUTS + i, 0], filters[_INPUTS + i, 1]
            jacobian[o, p + 2 + 2 * i] = out1 * f2 - out2 * ratio * f1
            jacobian[o, p + 3 + 2 * i] = out1 * f1 + out2 * f2
        jacobian[o, c + 2 * o] = x1
        jacobian[o, c + 2 * o + 1] = x2
        f1, f2 = filters[_START, 0], filters[_START, 1]
        jacobian[o, behind + at] = out1 * f2 - out2 * ratio * f1
        jacobian[o, behind + at + 1] = out1 * f1 + out2 * f2
    _advance_second(section, coupling, values, state, filters, signal)


@njit(cache=True, nogil=True, inline="always")
def _advance_second(
    section: np.ndarray,
    coupling: float,
    values: np.ndarray,
    state: np.ndarray,
    filters: np.ndarray,
    signal: np.ndarray,
) -> None:
    _, at, first, last, p = section
    sigma, bend = values[p], values[p + 1]
    x1, x2 = state[at], state[at + 1]
    driven1, driven2 = 0.0, 0.0
    for i in range(last - first):
        s = signal[first + i]
        driven1 += values[p + 2 + 2 * i] * s
        driven2 += values[p + 3 + 2 * i] * s
        f1, f2 = filters[_INPUTS + i, 0], filters[_INPUTS + i, 1]
        filters[_INPUTS + i, 0] = flushed(sigma * f1 + coupling * f2)
        filters[_INPUTS + i, 1] = flushed(sigma * f2 - bend * f1 + s)
    f1, f2 = filters[_SIGMA, 0], filters[_SIGMA, 1]
    filters[_SIGMA, 0] = flushed(sigma * f1 + coupling * f2 + x1)
    filters[_SIGMA, 1] = flushed(sigma * f2 - bend * f1 + x2)
    f1, f2 = filters[_BEND, 0], filters[_BEND, 1]
    filters[_BEND, 0] = flushed(sigma * f1 + coupling * f2)
    filters[_BEND, 1] = flushed(sigma * f2 - bend * f1 - x1)
    f1, f2 = filters[_START, 0], filters[_START, 1]
    filters[_START, 0] = flushed(sigma * f1 + coupling * f2)
    filters[_START, 1] = flushed(sigma * f2 - bend * f1)
    state[at] = flushed(sigma * x1 + coupling * x2 + driven1)
    state[at + 1] = flushed(sigma * x2 - bend * x1 + driven2)
