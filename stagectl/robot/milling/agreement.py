"""How a measured signal goes with one that was foreseen: its slope, its lateness, and how far off both may be.

What is measured has noise, and what no model knows, and both last: samples side by side are no independent witnesses.
So a trial is cut into blocks, and how blocks differ among themselves tells how far off the whole may be.
"""

from dataclasses import dataclass

import numpy as np

from stagectl.robot.milling.zero_phase import low_passed

CUTOFF = 5.0
"""Hz, up to which signals are held against each other: above is noise."""
FAST = 25.0
"""Hz, beyond which there is nothing but noise."""
BLOCK = 0.5
"""s, of a block: longer than what lasts of noise up to `CUTOFF`."""


@dataclass(frozen=True)
class Agreement:
    """How what was measured goes with what was foreseen.

    Parameters
    ----------
    slope : float, 1
        Of the former on the latter, by least squares over all axes, without their means.
    correlation : float, 1
    measured, foreseen : float
        Their standard deviations, in their unit.
    deviation : float, 1
        Standard error of the slope.
    noise : float
        Of the measured's standard deviation, what white noise makes.
    """

    slope: float
    correlation: float
    measured: float
    foreseen: float
    deviation: float
    noise: float


def agreement(measured: np.ndarray, foreseen: np.ndarray, rate: float, cutoff: float = CUTOFF) -> Agreement:
    """Hold a signal against another up to a frequency.

    Parameters
    ----------
    measured, foreseen : arrays, shape (N, width), any unit
    rate : float, samples/s
    cutoff : float, Hz

    Source
    ------
    The slope's standard error: the sandwich of White 1980, Econometrica 48, with samples of a block taken together, as
    Liang and Zeger 1986, Biometrika 73.
    """
    one, other = (_centred(low_passed(each, rate, cutoff)) for each in (measured, foreseen))
    power, cross = float(np.sum(other**2)), float(np.sum(one * other))
    own, tiny = float(np.sum(one**2)), np.finfo(float).tiny
    slope = cross / max(power, tiny)
    scores = _by_block(np.sum(other * (one - slope * other), axis=1), rate)
    return Agreement(
        slope,
        cross / max(np.sqrt(own * power), tiny),
        float(np.sqrt(own / one.size)),
        float(np.sqrt(power / one.size)),
        float(np.sqrt(np.sum(scores**2))) / max(power, tiny),
        _noise(measured, rate),
    )


def lateness(
    measured: np.ndarray, foreseen: np.ndarray, rate: float, most: float, allowed: float
) -> tuple[float, float]:
    """Return by how much what was foreseen is late, s, and by how many standard errors more than is allowed.

    Both are cut out of one trial; for each shift the slope that fits best is taken.

    Parameters
    ----------
    measured, foreseen : arrays, shape (N, width), any unit
    rate : float, samples/s
    most : float, s
        Largest shift that is looked for.
    allowed : float, s
        Shifts that are.

    Returns
    -------
    (float, float), s and 1
        The second is 0 for a shift that is allowed.

    Source
    ------
    Davidson and MacKinnon 1981, Econometrica 49: the better of two regressions beside the other, by how much of the
    difference between what they foresee is in what the other one leaves; its standard error as of `agreement`.
    """
    reach = round(most * rate)
    shifts = np.arange(-reach, reach + 1)
    one, other = (low_passed(each, rate, CUTOFF) for each in (measured, foreseen))
    here = _centred(one[reach : len(one) - reach])
    fits = np.stack([_fit(here, _centred(other[reach + k : len(other) - reach + k])) for k in shifts])
    left = np.sum((here - fits) ** 2, axis=(1, 2))
    best = int(np.argmin(left))
    late = float(shifts[best]) / rate
    if abs(late) <= allowed:
        return late, 0.0
    within = np.flatnonzero(np.abs(shifts) <= allowed * rate)
    right = within[np.argmin(left[within])]
    way = fits[best] - fits[right]
    scores = _by_block(np.sum((here - fits[best]) * way, axis=1), rate)
    deviation = float(np.sqrt(np.sum(scores**2)))
    return late, float(np.sum((here - fits[right]) * way)) / max(deviation, np.finfo(float).tiny)


def _fit(measured: np.ndarray, foreseen: np.ndarray) -> np.ndarray:
    """Return what was foreseen times the slope that fits best, none below zero."""
    power = max(float(np.sum(foreseen**2)), np.finfo(float).tiny)
    return np.asarray(max(float(np.sum(measured * foreseen)) / power, 0.0) * foreseen)


def _by_block(samples: np.ndarray, rate: float) -> np.ndarray:
    """Return the sum of each block of samples, shape (blocks,); the last one may be shorter."""
    return np.asarray(np.add.reduceat(samples, np.arange(0, len(samples), round(BLOCK * rate))))


def _noise(signal: np.ndarray, rate: float) -> float:
    """Return the standard deviation up to `CUTOFF` of the white noise that a signal has beyond `FAST`."""
    fast = signal - low_passed(signal, rate, FAST)
    return float(fast.std() * np.sqrt(CUTOFF / max(0.5 * rate - FAST, CUTOFF)))


def _centred(signal: np.ndarray) -> np.ndarray:
    return np.asarray(signal - signal.mean(axis=0))
