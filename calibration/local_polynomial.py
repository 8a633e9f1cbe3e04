"""What is smooth over a few lines, from noisy ones: local polynomials, and what they leave as variance."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Smoothed:
    """A response on the lines wanted.

    Parameters
    ----------
    value : complex array, shape (wanted, ...), the response's unit
    variance : array, shape (wanted, ...), the response's unit squared
        Of the complex value: E |value - truth|^2, from what the polynomials leave at the lines of the window.
    """

    value: np.ndarray
    variance: np.ndarray


AT_ONCE = 256
"""Lines fitted together: their windows are in memory."""


def local_polynomial(lines: np.ndarray, response: np.ndarray, wanted: np.ndarray, reach: int, degree: int) -> Smoothed:
    """Fit a polynomial to the lines around each wanted one by least squares, and read it there.

    Parameters
    ----------
    lines : array, shape (lines,), any unit, rising
        Evenly spaced or with gaps.
    response : complex array, shape (lines, ...), any unit
        Raw: noise and distortion differ from line to line as if drawn anew.
    wanted : array, shape (wanted,), the lines' unit
    reach : int
        Lines to each side in a window; at the ends of the band the window is the last that is whole.
    degree : int, < 2 reach

    Returns
    -------
    Smoothed

    Raises
    ------
    ValueError : fewer lines than a window has.

    Source
    ------
    Pintelon, Schoukens, Vandersteen and Barbe 2010, "Estimation of nonparametric noise and FRF models for
    multivariable systems", Mech. Syst. Signal Process. 24(3), the robust form: periods first, polynomials then.

    Departs
    -------
    The transient is not a polynomial here: the response is periodic after the run-in, and what is not is in the
    variance.
    """
    count = 2 * reach + 1
    if not len(lines) >= count:
        raise ValueError(f"{len(lines)} bins, must be at least {count} for windows of {count}")
    if not 0 <= degree < 2 * reach:
        raise ValueError(f"degree is {degree}, must be 0 to {2 * reach - 1} for a reach of {reach}")
    columns, shape = response.reshape(len(lines), -1), (len(wanted), *response.shape[1:])
    value = np.empty((len(wanted), columns.shape[1]), np.result_type(columns, float))
    variance = np.empty(value.shape)
    for start in range(0, len(wanted), AT_ONCE):
        part = slice(start, start + AT_ONCE)
        value[part], variance[part] = _fit(lines, columns, wanted[part], reach, degree)
    return Smoothed(value.reshape(shape), variance.reshape(shape))


def _fit(
    lines: np.ndarray, columns: np.ndarray, wanted: np.ndarray, reach: int, degree: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return values and variances, (wanted, columns), of a few wanted lines."""
    count = 2 * reach + 1
    first = np.clip(np.searchsorted(lines, wanted) - reach, 0, len(lines) - count)
    window = first[:, None] + np.arange(count)
    offset = lines[window] - wanted[:, None]
    scale = np.abs(offset).max(axis=1, keepdims=True)
    orthogonal, upper = np.linalg.qr((offset / scale)[..., None] ** np.arange(degree + 1))
    data = columns[window]
    share = orthogonal.swapaxes(1, 2) @ data
    weight = np.linalg.inv(upper)[:, 0, :]  # at offset 0 the polynomial is its constant
    value = np.einsum("wp,wpc->wc", weight, share)
    freedom = count - degree - 1
    power = np.maximum((np.abs(data) ** 2).sum(axis=1) - (np.abs(share) ** 2).sum(axis=1), 0.0) / freedom
    return value, power * np.sum(weight**2, axis=1)[:, None]


RANK = 1e-4
"""Of the largest singular value: what a window shows no better of is left out."""


def local_transfer(
    lines: np.ndarray, given: np.ndarray, followed: np.ndarray, wanted: np.ndarray, reach: int, degree: int
) -> Smoothed:
    """Fit followed = T given with a T that is a polynomial over the lines around each wanted one, and read it there.

    Strong lines count for more: the residual of `followed`, not of its ratio to `given`, is made small.

    Parameters
    ----------
    lines : array, shape (lines,), any unit, rising
    given : complex array, shape (lines, inputs, experiments), any unit
    followed : complex array, shape (lines, outputs, experiments), any unit
    wanted : array, shape (wanted,), the lines' unit
    reach : int
        Lines to each side in a window.
    degree : int, >= 0

    Returns
    -------
    Smoothed
        Of T, shape (wanted, outputs, inputs).  With more inputs than experiments it is the smallest that fits: it says
        nothing of what the experiments do not show.

    Raises
    ------
    ValueError : fewer lines than a window has, or too few equations.

    Source
    ------
    Pintelon and Schoukens 2012, System Identification, sec. 7.3: the local polynomial method with a general input.

    Departs
    -------
    Noise in `given` is not a part of the model; it draws T towards zero by its power over that of `given`.
    """
    count, inputs = 2 * reach + 1, given.shape[1]
    freedom = count * given.shape[2] - inputs * (degree + 1)
    if not (len(lines) >= count and freedom > 0):
        raise ValueError(
            f"{len(lines)} bins and {given.shape[2]} experiments, must be at least {count} bins, and more than "
            f"{inputs * (degree + 1)} equations in a window"
        )
    first = np.clip(np.searchsorted(lines, wanted) - reach, 0, len(lines) - count)
    window = first[:, None] + np.arange(count)
    offset = lines[window] - wanted[:, None]
    power = (offset / np.abs(offset).max(axis=1, keepdims=True))[..., None] ** np.arange(degree + 1)
    rows = np.einsum("wkie,wkd->wkedi", given[window], power).reshape(len(wanted), -1, (degree + 1) * inputs)
    data = followed[window].swapaxes(2, 3).reshape(len(wanted), -1, followed.shape[1])
    solver = np.linalg.pinv(rows, rcond=RANK)
    solution = solver @ data
    left = (np.abs(data - rows @ solution) ** 2).sum(axis=1) / freedom
    gain = (np.abs(solver[:, :inputs]) ** 2).sum(axis=2)
    return Smoothed(solution[:, :inputs].swapaxes(1, 2), left[:, :, None] * gain[:, None, :])
