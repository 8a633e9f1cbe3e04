"""Poles and mode shapes of a frequency response by a subspace method, and how the modes are driven."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lstsq, qr, svd

from calibration.frequency_domain.modal_form import ModalForm

LEAST_DECAY = 1e-5
"""Of a pole's size: what is nearer to the imaginary axis, or beyond it, is taken there."""


@dataclass(frozen=True, eq=False)
class Subspace:
    """What a response says of the states, for every order.

    Parameters
    ----------
    observability : array, shape (p rows, count), 1
        The first n columns are those of order n.
    singular_values : array, shape (count,), 1
    outputs : int
    """

    observability: np.ndarray
    singular_values: np.ndarray
    outputs: int


def subspace_of(points: np.ndarray, response: np.ndarray, weight: np.ndarray, rows: int) -> Subspace:
    """Find the observability of a response on the imaginary axis.

    The axis goes onto the unit circle by z = (1 + s) / (1 - s), so that its middle, |s| = 1, lies at z = j and the
    powers of z tell frequencies apart whatever the band is.

    Parameters
    ----------
    points : complex array, shape (K,), 1
        Values of s, scaled so that the band lies around 1.
    response : complex array, shape (K, p, m), 1
    weight : array, shape (K,), 1
        Of each frequency.
    rows : int
        Block rows, more than the largest order over the outputs.

    Source
    ------
    McKelvey, Akçay and Ljung 1996, "Subspace-based multivariable system identification from frequency response data",
    IEEE Trans. Automatic Control 41, 960-979, algorithm 2; columns are weighted as in its section V.
    """
    count, p, m = response.shape
    powers = ((1 + points) / (1 - points)) ** np.arange(rows)[:, np.newaxis] * weight
    low = (powers[:, np.newaxis, :, np.newaxis] * np.eye(m)[:, np.newaxis, :]).reshape(rows * m, count * m)
    high = (powers[:, np.newaxis, :, np.newaxis] * response.transpose(1, 0, 2)).reshape(rows * p, count * m)
    both = np.vstack([low, high])
    (triangle,) = qr(np.hstack([both.real, both.imag]).T, mode="r")
    triangle = triangle[: rows * (m + p)].T
    left, values, _ = svd(triangle[rows * m :, rows * m :], full_matrices=False)
    return Subspace(left, values, p)


def realized(
    found: Subspace, order: int, points: np.ndarray, response: np.ndarray, sigma: np.ndarray, is_direct: bool
) -> ModalForm:
    """Return the system of an order: poles and shapes by shift invariance, B and D by weighted least squares.

    Parameters
    ----------
    found : Subspace
    order : int
    points : complex array, shape (K,), 1
    response : complex array, shape (K, p, m), 1
    sigma : array, shape (K, p, m), 1
        Standard error of each element.
    is_direct : bool
        Whether D is fitted; else it is 0.
    """
    gamma = found.observability[:, :order]
    shift, *_ = lstsq(gamma[: -found.outputs], gamma[found.outputs :])
    circle, shapes = np.linalg.eig(shift)
    poles = (circle - 1) / (circle + 1)
    seen = gamma[: found.outputs] @ shapes
    size = np.abs(poles)
    decay = np.maximum(np.abs(poles.real), LEAST_DECAY * np.maximum(size, LEAST_DECAY))
    pair, single = np.flatnonzero(poles.imag > 0), np.flatnonzero(poles.imag == 0)
    seen = seen / np.maximum(np.linalg.norm(seen, axis=0), np.finfo(float).tiny)
    columns = [part for at in pair for part in (seen[:, at].real, seen[:, at].imag)]
    columns += [seen[:, at].real for at in single]
    form = ModalForm(
        np.concatenate([decay[pair], decay[single]]),
        poles[pair].imag,
        np.zeros((order, response.shape[2])),
        np.stack(columns, axis=1),
        np.zeros(response.shape[1:]),
    )
    return driven(form, points, response, sigma, is_direct)


def driven(form: ModalForm, points: np.ndarray, response: np.ndarray, sigma: np.ndarray, is_direct: bool) -> ModalForm:
    """Return a system with B and D that fit a response best, poles and C as they are.

    Parameters
    ----------
    form : ModalForm
    points : complex array, shape (K,), 1
    response, sigma : arrays, shape (K, p, m), 1
    is_direct : bool
    """
    (count, p, m), n = response.shape, form.order
    terms = np.zeros((count, p, n + p * is_direct), complex)
    terms[:, :, :n] = form.outlets(points)
    if is_direct:
        terms[:, :, n:] = np.eye(p)
    inlet, direct = np.zeros((n, m)), np.zeros((p, m))
    for column in range(m):
        each = (terms / sigma[:, :, column, np.newaxis]).reshape(count * p, -1)
        wanted = (response[:, :, column] / sigma[:, :, column]).ravel()
        solved, *_ = lstsq(np.vstack([each.real, each.imag]), np.concatenate([wanted.real, wanted.imag]))
        inlet[:, column] = solved[:n]
        if is_direct:
            direct[:, column] = solved[n:]
    return ModalForm(form.decay, form.turn, inlet, form.C, direct)
