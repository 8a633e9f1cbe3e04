"""How much of a correction to make, as the trials so far show: less where they came out otherwise than predicted."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from scipy.fft import rfft, rfftfreq

from stagectl.robot.milling.learning import LearningLaw, predicted

LINES = 400
"""Frequencies at which it is found."""
WIDTH, LEAST = 0.35, 0.1
"""Of a frequency, and Hz at least: so far to either side spectra are summed."""


def heeding(law: LearningLaw, sent: Sequence[np.ndarray], come: Sequence[np.ndarray]) -> LearningLaw:
    """Return a law whose Q is lowered to the part that the changes of the path so far have proved right.

    From one trial to the next the path changed by du, where the tool came by dy, and the models had said dp = P du.  Of
    all real factors on the next change, g = Re <dp, dy> / <dy, dy> leaves the least error, if that one comes out as
    they did; it is found at each frequency, over all pairs of trials and axes, and above 1 counts as 1.  It is small
    where the cut answers by more than its model, late, or each time otherwise - what is gone does not push back - and
    where there is more noise than motion.

    Parameters
    ----------
    law : LearningLaw
    sent, come : sequences of arrays, shape (N, 3), m
        The paths sent so far, and where the tool came: the same number of both.  After one trial the law stays.

    Returns
    -------
    LearningLaw
        Its Q is still without phase, and nowhere above the law's: where errors shrank by the models, they still do.
    """
    cross, own = np.zeros(1), np.zeros(1)
    for (u, v), (y, z) in zip(pairwise(sent), pairwise(come), strict=True):
        told, seen = rfft(predicted(np.zeros_like(u), v - u, law), axis=0), rfft(z - y, axis=0)
        cross = cross + (told.conj() * seen).real.sum(axis=1)
        own = own + (seen.conj() * seen).real.sum(axis=1)
    if not own.any():
        return law
    frequency = np.linspace(0.0, law.highest, LINES)
    lines = rfftfreq(len(sent[0]), 1.0 / law.axes[0].rate)
    reach = np.maximum(WIDTH * frequency, LEAST)
    first, last = np.searchsorted(lines, [frequency - reach, frequency + reach])
    wrong, right = (_sums(power, first, np.maximum(last, first + 1)) for power in (own, cross))
    part = np.clip(right / np.maximum(wrong, np.finfo(float).tiny), 0.0, 1.0)
    return replace(law, caution=(frequency, part if law.caution is None else part * np.interp(frequency, *law.caution)))


def _sums(power: np.ndarray, first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """Return the sum from each first line up to, and without, its last."""
    whole = np.concatenate([[0.0], np.cumsum(power)])
    return np.asarray(whole[last] - whole[first])
