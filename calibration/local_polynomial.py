"""A response that is smooth over a few lines, from noisy ones: local polynomials, and what they leave as variance."""

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
        raise ValueError(f"{len(lines)} lines, must be at least {count} for windows of {count}")
    if not 0 <= degree < 2 * reach:
        raise ValueError(f"degree is {degree}, must be 0 to {2 * reach - 1} for a reach of {reach}")
    nearest = np.searchsorted(lines, wanted)
    first = np.clip(nearest - reach, 0, len(lines) - count)
    window = first[:, None] + np.arange(count)
    offset = lines[window] - wanted[:, None]
    scale = np.abs(offset).max(axis=1, keepdims=True)
    orthogonal, upper = np.linalg.qr((offset / scale)[..., None] ** np.arange(degree + 1))
    data = response.reshape(len(lines), -1)[window]
    share = orthogonal.swapaxes(1, 2) @ data
    weight = np.linalg.inv(upper)[:, 0, :]  # at offset 0 the polynomial is its constant
    value = np.einsum("wp,wpc->wc", weight, share)
    freedom = count - degree - 1
    power = np.maximum((np.abs(data) ** 2).sum(axis=1) - (np.abs(share) ** 2).sum(axis=1), 0.0) / freedom
    variance = power * np.sum(weight**2, axis=1)[:, None]
    shape = (len(wanted), *response.shape[1:])
    return Smoothed(value.reshape(shape), variance.reshape(shape))
