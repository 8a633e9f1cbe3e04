"""Where in a recording a known signal lies, and by how much the recorder's clock differs from the player's."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import make_interp_spline

STEPS = 8
"""Of Gauss-Newton, at most; from within a tenth of a period three are enough."""
SETTLED = 1e-5
"""samples: a step that moves the signal by less is the last."""
BLOCK = 0.05
"""s over which what is left of a fit goes together, for its errors."""
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
    gain : array, shape (channels,), the recording's per the signal's unit
        Negative where a channel is inverted.
    likeness : array, shape (channels,), 0 to 1
        Correlation of a recorded channel with the signal, so moved: its square is the part of the power that is it.
    """

    delay: float
    drift: float
    delay_error: float
    drift_error: float
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
        step, error = _solved(rows, left, rate)
        middle += step[0]
        slope += step[1] if with_drift else 0.0
        if abs(step[0]) + abs(step[1]) * centre < SETTLED:
            break
    power = np.maximum((measured**2).sum(axis=0), np.finfo(float).tiny)
    likeness = np.sqrt(np.clip((gain * moved * measured).sum(axis=0) / power, 0.0, 1.0))
    delay_error = math.hypot(error[0], centre * error[1])
    return Timing(middle - centre * (1 + slope), 1e6 * slope, delay_error, 1e6 * error[1], gain, likeness)


def _rows(fitted: np.ndarray, moving: np.ndarray, lever: np.ndarray, with_drift: bool) -> np.ndarray:
    """Return what delay and slope do to the fit, (samples, channels, 2), less what the gains could do as well."""
    rows = np.stack([moving, moving * lever[:, None] * with_drift], axis=2)
    size = np.maximum((fitted**2).sum(axis=0), np.finfo(float).tiny)
    share = np.einsum("nc,nck->ck", fitted, rows) / size[:, None]
    free: np.ndarray = rows - fitted[:, :, None] * share
    return free


def _solved(rows: np.ndarray, left: np.ndarray, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Solve for delay and slope; return both, and their errors with what is left going together within blocks."""
    square = np.einsum("ncj,nck->jk", rows, rows)
    pull = np.einsum("nck,nc->nk", rows, left)
    inverse = np.linalg.pinv(square, rcond=1e-14, hermitian=True)
    size = max(1, round(BLOCK * rate))
    blocks = np.add.reduceat(pull - pull.mean(axis=0), np.arange(0, len(pull), size), axis=0)
    covariance = inverse @ (blocks.T @ blocks) @ inverse
    return inverse @ pull.sum(axis=0), np.sqrt(np.maximum(np.diag(covariance), 0.0))
