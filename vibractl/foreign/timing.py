"""Where in a recording a known signal lies, and by how much the recorder's clock differs from the player's."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import make_interp_spline

STEPS = 8
"""Of Gauss-Newton, at most; from within a tenth of a period three are enough."""
SETTLED = 3e-3
"""samples: a step that moves the signal by less is the last; what is left then is its square, or a tenth of it."""
BLOCK = 0.05
"""s over which noise that is left of a fit goes together, for its errors."""
PARTS = 8
"""Of the signal: over one of them, what is left of a fit goes together if it is no noise but another signal."""
ORDER = 5
"""Of the splines by which a signal is moved by parts of a sample."""


@dataclass(frozen=True)
class Timing:
    """Where a signal lies in a recording: x(n) comes at sample `delay` + (1 + 1e-6 `drift`) n.

    Parameters
    ----------
    delay : float, samples
        Of the signal's first sample.
    drift : float, ppm
        By how much longer the recording is: the recorder's clock is so much faster than the player's.
    delay_error, drift_error : float, samples and ppm
        One standard deviation each, of what noise makes of them.
    centre, centre_error : float, samples
        By how much its middle comes later than it would at delay 0 without drift.
    centre_misfit, drift_misfit : float, samples and ppm
        How far both may be off since the recording is not that signal but one like it: as far as its parts differ.
    gain : array, shape (channels,), the recording's per the signal's unit
        Negative where a channel is inverted.
    likeness : array, shape (channels,), 0 to 1
        Correlation of a recorded channel with the signal, so moved: its square is the part of the power that is it.
    """

    delay: float
    drift: float
    delay_error: float
    drift_error: float
    centre: float
    centre_error: float
    centre_misfit: float
    drift_misfit: float
    gain: np.ndarray
    likeness: np.ndarray

    @property
    def whole(self) -> int:
        """Samples, without the fraction."""
        return round(self.delay)


def timing(signal: np.ndarray, recorded: np.ndarray, rate: float, begin: float, with_drift: bool = True) -> Timing:
    """Refine where a signal lies in a recording, to a part of a sample, by least squares.

    Parameters
    ----------
    signal : array, shape (length, channels), any unit
        Well below half the rate: it is moved by splines.
    recorded : array, shape (samples, channels), any unit
    rate : float, samples/s
    begin : float, samples
        About where its first sample is: to within a tenth of its shortest period.
    with_drift : bool
        Else the clocks are taken for one.

    Source
    ------
    Kay 1993, Fundamentals of Statistical Signal Processing: Estimation Theory, sec. 3.11 (time delay) and 8.9.
    """
    length = len(signal)
    index = np.arange(length, dtype=float)
    centre = (length - 1) / 2
    middle, slope = begin + centre, 0.0
    first = max(math.floor(begin) - 8 - math.ceil(1e-3 * length), 0)
    last = min(math.ceil(begin) + length + 8 + math.ceil(1e-3 * length), len(recorded))
    at = np.arange(first, last, dtype=float)
    spline = make_interp_spline(index, signal, k=ORDER)
    derivative = spline.derivative()
    heard = recorded[first:last]
    gain = np.zeros(signal.shape[1])
    for _ in range(STEPS):
        turned = (at - middle) / (1 + slope) + centre
        inside = (turned >= 0) & (turned <= length - 1)
        moved, rising = spline(turned[inside]), derivative(turned[inside])
        measured, lever = heard[inside], turned[inside] - centre
        gain = np.einsum("nc,nc->c", moved, measured) / np.maximum((moved**2).sum(axis=0), np.finfo(float).tiny)
        left = measured - gain * moved
        rows = _rows(gain * moved, -gain * rising, lever, with_drift)
        inverse = _inverse(rows)
        step = inverse @ np.einsum("nck,nc->k", rows, left)
        middle += step[0]
        slope += step[1] if with_drift else 0.0
        if abs(step[0]) + abs(step[1]) * centre < SETTLED:
            break
    power = np.maximum((measured**2).sum(axis=0), np.finfo(float).tiny)
    likeness = np.sqrt(np.clip((gain * moved * measured).sum(axis=0) / power, 0.0, 1.0))
    pull = np.einsum("nck,nc->nk", rows, left)
    error = _errors(inverse, pull, max(1, round(BLOCK * rate)))
    apart = PARTS * (_errors(inverse, pull, -(-len(pull) // PARTS)) ** 2 - error**2)
    misfit = np.sqrt(np.maximum(apart, 0.0))
    delay, delay_error = middle - centre * (1 + slope), math.hypot(error[0], centre * error[1])
    centred = middle - centre, float(error[0]), float(misfit[0]), float(1e6 * misfit[1])
    return Timing(delay, 1e6 * slope, delay_error, float(1e6 * error[1]), *centred, gain, likeness)


def _rows(fitted: np.ndarray, moving: np.ndarray, lever: np.ndarray, with_drift: bool) -> np.ndarray:
    """Return what delay and slope do to the fit, (samples, channels, 2), less what the gains could do as well."""
    rows = np.stack([moving, moving * lever[:, None] * with_drift], axis=2)
    size = np.maximum((fitted**2).sum(axis=0), np.finfo(float).tiny)
    share = np.einsum("nc,nck->ck", fitted, rows) / size[:, None]
    free: np.ndarray = rows - fitted[:, :, None] * share
    return free


def _inverse(rows: np.ndarray) -> np.ndarray:
    return np.linalg.pinv(np.einsum("ncj,nck->jk", rows, rows), rcond=1e-14, hermitian=True)


def _errors(inverse: np.ndarray, pull: np.ndarray, size: int) -> np.ndarray:
    """Return the errors of both, where what is left, (samples, 2), goes together over blocks of so many samples."""
    blocks = np.add.reduceat(pull - pull.mean(axis=0), np.arange(0, len(pull), size), axis=0)
    covariance = inverse @ (blocks.T @ blocks) @ inverse
    return np.sqrt(np.maximum(np.diag(covariance), 0.0))
