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
TINY = np.finfo(float).tiny
"""Least power that is divided by."""
FLOOR = 0.05
"""Part that is made in any case: where nothing was changed nothing would be proved, and never be again."""


def heeding(
    law: PathLaw,
    sent: Sequence[np.ndarray],
    come: Sequence[np.ndarray],
    cuts: Sequence[MeasuredCut | None] = (),
    error: np.ndarray | None = None,
) -> PathLaw:
    """Return a law whose Q is no more than the part that the changes of the path have proved right.

    From trial to trial the tool came by dy, for which the law would have asked for a change of the path dn, where it
    was du.  Of all real factors on the law's correction g = Re sum <dn, du> / sum <dn, dn> over all changes would have
    come closest, in the mean square; it is found at each frequency and along each direction, and held between `FLOOR`
    and 1.  It is small where the cut answers by more than its model, late, or each time otherwise - what is gone does
    not push back - and where a joint that turns around sticks or has backlash, which answers by up to twice as much as
    in motion.  A large change tells more of it than a small one, which is lost in what trials differ by themselves.

    That is s^2 in a trial, by the tracker's noise and the blocks' hardness: half of what dn has beyond a multiple of
    du, in the mean of all changes after the first, which is the large one.  With an error, once there is such a change,
    the part is 1 - s^2 / c^2 of g, where c is the correction asked for: Wiener's filter, so that noise is not learned.

    Parameters
    ----------
    law : PathLaw
    sent, come : sequences of arrays, shape (N, 3), m
        The paths sent so far, and where the tool came: the same number of both.  After one trial the law stays.
    cuts : sequence of MeasuredCut or None, optional
        Of each trial, as `update` takes it.
    error : array, shape (N, 3), m, optional
        That is learned from next.

    Returns
    -------
    PathLaw
        Its Q is still without phase, and nowhere above the law's: where errors shrank by the models, they still do.
    """
    if len(sent) < 2:
        return law
    bold, frequency = replace(law, caution=None), np.linspace(0.0, law.highest, LINES)
    lines = rfftfreq(len(sent[0]), 1.0 / law.axes[0].rate)
    cuts = cuts or [None] * len(sent)
    found = []
    for made, answer, cut in zip(np.diff(sent, axis=0), np.diff(come, axis=0), cuts[:-1], strict=True):
        changed = bold.passed(lines) * rfft(made, axis=0)
        needed = rfft(correction(answer, bold, cut), axis=0)
        powers = (needed.conj() * changed).real, np.abs(needed) ** 2, np.abs(changed) ** 2
        found.append([_near(each, lines, frequency) for each in powers])
    cross, own, moved = np.array(found).swapaxes(0, 1)
    part = np.clip(cross.sum(axis=0) / np.maximum(own.sum(axis=0), TINY), FLOOR, 1.0)
    if error is not None and len(found) > 1:
        asked = _near(np.abs(rfft(correction(error, bold, cuts[-1]), axis=0)) ** 2, lines, frequency)
        noise = 0.5 * (own - cross**2 / np.maximum(moved, TINY))[1:].mean(axis=0)
        part = np.maximum(part * (1.0 - noise / np.maximum(asked, TINY)), FLOOR)
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


def _near(power: np.ndarray, lines: np.ndarray, frequency: np.ndarray) -> np.ndarray:
    """Return the power of each column, shape (lines, 3), around frequencies: shape (bins, 3)."""
    reach = np.maximum(WIDTH * frequency, LEAST)
    first, last = np.searchsorted(lines, [frequency - reach, frequency + reach])
    whole = np.concatenate([np.zeros((1, power.shape[1])), np.cumsum(power, axis=0)])
    return np.asarray(whole[np.maximum(last, first + 1)] - whole[first])
