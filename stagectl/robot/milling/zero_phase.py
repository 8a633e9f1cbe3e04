"""Filters over a whole trial, forwards and backwards in time alike: without phase, inverses, any response."""

from collections.abc import Callable

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft, rfftfreq

Response = Callable[[np.ndarray], np.ndarray]
"""From frequencies, shape (bins,), Hz, to a frequency response, complex, shape (bins, outputs, inputs)."""


def low_pass(frequency: np.ndarray, cutoff: float, order: int = 4, highest: float = np.inf) -> np.ndarray:
    """Return the response of a Butterworth low-pass that is run forwards and backwards: real, shape (bins,).

    Parameters
    ----------
    frequency : array, shape (bins,), Hz
    cutoff : float, Hz, > 0
        Where it is 1/2.
    order : int
        Of the low-pass that is run twice.
    highest : float, Hz
        It is zero above.

    Examples
    --------
    >>> low_pass(np.array([0.0, 10.0, 30.0]), 10.0, 2, 25.0)
    array([1. , 0.5, 0. ])
    """
    frequency = np.abs(np.asarray(frequency, float))
    passed: np.ndarray = 1.0 / (1.0 + (frequency / cutoff) ** (2 * order))
    return np.where(frequency <= highest, passed, 0.0)


def low_passed(signal: np.ndarray, rate: float, cutoff: float) -> np.ndarray:
    """Return what a whole trial has up to a frequency, each channel by itself, shape (N, width), the signal's unit.

    Parameters
    ----------
    signal : array, shape (N, width), any unit
    rate : float, samples/s
    cutoff : float, Hz
        As of `low_pass`.

    Raises
    ------
    ValueError : a value that is not finite.
    """
    signal = np.asarray(signal, float)
    return filtered(
        signal, rate, lambda frequency: low_pass(frequency, cutoff)[:, None, None] * np.eye(signal.shape[1])
    )


def filtered(signal: np.ndarray, rate: float, response: Response) -> np.ndarray:
    """Run a filter, causal or not, over a whole trial.

    Beyond its ends the trial goes on as its mirror image, so that nothing jumps there and noise at an end counts as
    little as anywhere.  Where a trial rests at its ends for as long as the filter remembers, that is exact: before and
    after, all stays as it rests.

    Parameters
    ----------
    signal : array, shape (N, inputs), any unit
    rate : float, samples/s
    response : callable
        Of the filter: from frequencies, shape (bins,), Hz, to complex, shape (bins, outputs, inputs).

    Returns
    -------
    array, shape (N, outputs), the response's times the signal's unit

    Raises
    ------
    ValueError : another shape, or a value that is not finite.
    """
    signal = np.asarray(signal, float)
    if signal.ndim != 2 or not len(signal):
        raise ValueError(f"a trial has shape {signal.shape}, must be (samples, width)")
    if not np.isfinite(signal).all():
        sample, channel = np.argwhere(~np.isfinite(signal))[0]
        raise ValueError(f"channel {channel + 1} of the trial is not finite at sample {sample}")
    count = next_fast_len(2 * len(signal), real=True)
    held = count - 2 * len(signal)  # the last sample before the mirror's stands so much longer
    whole = np.concatenate([signal, np.repeat(signal[-1:], held, axis=0), signal[::-1]])
    lines = rfft(whole, axis=0)[..., None]
    found = (response(rfftfreq(count, 1.0 / rate)) @ lines)[..., 0]
    return np.asarray(irfft(found, count, axis=0)[: len(signal)])
