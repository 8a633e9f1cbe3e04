"""How much of a correction to make, as the last one shows: less where it came out otherwise than predicted."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.fft import rfft, rfftfreq

from stagectl.robot.milling.agreement import agreement
from stagectl.robot.milling.learning import PathLaw, correction
from stagectl.robot.milling.measured_cut import MeasuredCut

LINES = 400
"""Frequencies at which it is found."""
WIDTH, LEAST = 0.35, 0.1
"""Of a frequency, and Hz at least: so far to either side spectra are summed."""
SURE = 1.645
"""Standard errors by which a correction has to make errors smaller: one-sided, 95 %."""
FLOOR = 0.05
"""Part that is made in any case: where nothing was changed nothing would be proved, and never be again."""


def heeding(
    law: PathLaw, sent: Sequence[np.ndarray], come: Sequence[np.ndarray], cut: MeasuredCut | None = None
) -> PathLaw:
    """Return a law whose Q is no more than the part that the last change of the path has proved right.

    From the last trial but one to the last the tool came by dy, for which the law would have asked for a change of the
    path dn, where it was du.  Of all real factors on the law's correction g = Re <dn, du> / <dn, dn> would have come
    closest, in the mean square; it is found at each frequency and along each direction, and held between `FLOOR` and 1.
    It is small where the cut answers by more than its model, late, or each time otherwise - what is gone does not push
    back - where a joint that turns around sticks or has backlash, which answers by up to twice as much as in motion,
    and where less was moved than trials differ by themselves: by the tracker's noise, and by the blocks' hardness.

    Parameters
    ----------
    law : PathLaw
    sent, come : sequences of arrays, shape (N, 3), m
        The paths sent so far, and where the tool came: the same number of both.  After one trial the law stays.
    cut : MeasuredCut, optional
        Of the last trial but one, as `update` takes it.

    Returns
    -------
    PathLaw
        Its Q is still without phase, and nowhere above the law's: where errors shrank by the models, they still do.
    """
    if len(sent) < 2:
        return law
    bold, lines = replace(law, caution=None), rfftfreq(len(sent[0]), 1.0 / law.axes[0].rate)
    made = bold.passed(lines) * rfft(sent[-1] - sent[-2], axis=0)
    needed = rfft(correction(come[-1] - come[-2], bold, cut), axis=0)
    cross, own = ((needed.conj() * each).real for each in (made, needed))
    frequency = np.linspace(0.0, law.highest, LINES)
    reach = np.maximum(WIDTH * frequency, LEAST)
    first, last = np.searchsorted(lines, [frequency - reach, frequency + reach])
    wrong, right = (_sums(power, first, np.maximum(last, first + 1)) for power in (own, cross))
    part = np.clip(right / np.maximum(wrong, np.finfo(float).tiny), FLOOR, 1.0)
    return law.more_cautious(frequency, part)


def witnessed(error: np.ndarray, change: np.ndarray, law: PathLaw) -> float:
    """Return the part of a correction that makes the errors smaller that a witness saw, 0 to 1.

    A method that does not know the tool's place corrects what it believes the errors to be.  With c the change of the
    tool that a correction is foreseen to make, the part s leaves the witness |e - s c|^2, which is least at the slope
    b = <e, c> / <c, c> and less than |e|^2 up to 2 b.  So s is at most b, and at most twice what b surely is: 0 where
    nothing is to be won.

    Parameters
    ----------
    error : array, shape (N, 3), m
        As the witness, a tracker, saw them, where they count.
    change : array, shape (N, 3), m
        That is foreseen of the tool, by its G_R.
    law : PathLaw
        Has the rate, and the frequency up to which errors are learned.
    """
    found = agreement(error, change, law.axes[0].rate, law.cutoff)
    return float(np.clip(min(found.slope, 2.0 * (found.slope - SURE * found.deviation)), 0.0, 1.0))


def _sums(power: np.ndarray, first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """Return the sum of each column from each first line up to, and without, its last."""
    whole = np.concatenate([np.zeros((1, power.shape[1])), np.cumsum(power, axis=0)])
    return np.asarray(whole[last] - whole[first])
