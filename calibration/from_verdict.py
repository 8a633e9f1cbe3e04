"""Whether a model from recordings is good, usable or has no value, band by band, and why."""

from collections import Counter
from dataclasses import dataclass

import numpy as np

from calibration.from_recordings import Found
from calibration.sweep_summary import BANDS, relative_deviation

GOOD = 0.15
"""Relative standard deviation of G of 95 % of the lines, up to which a band is good: the experiment's own are 0.07 to
0.14 (docs/calibration.md)."""

VERDICT_HEAD = ("band", "verdict", "why", "lines", "median deviation, %", "95 % within", "median coherence")


@dataclass(frozen=True)
class Verdict:
    """On one band.

    Parameters
    ----------
    low, high : float, Hz
    word : str
        "good", "usable" or "no value".
    reason : str
        Empty where it is good.
    lines, wanted : int
        That have values, and that were asked for.
    median, tail : float, 1
        Relative standard deviation of G, and what 95 % of the lines are within; NaN without values.
    coherence : float, 0 to 1
        Median; NaN without values.
    """

    low: float
    high: float
    word: str
    reason: str
    lines: int
    wanted: int
    median: float
    tail: float
    coherence: float

    @property
    def row(self) -> tuple[str, ...]:
        """It as a row of a table."""
        deviation = (f"{100 * self.median:.3g}", f"{100 * self.tail:.3g}", f"{self.coherence:.4f}")
        figures = deviation if self.lines else ("-",) * 3
        band = f"{self.low:g} to {self.high:g} Hz"
        return (band, self.word, self.reason, f"{self.lines} of {self.wanted}", *figures)


def verdicts(found: Found) -> list[Verdict]:
    """Judge each band that was asked for.

    Parameters
    ----------
    found : Found
    """
    relative, coherence = relative_deviation(found.matrix), found.matrix.coherence.min(axis=(1, 2))
    judged = []
    for low, high in zip(BANDS, BANDS[1:], strict=False):
        wanted = found.wanted[(found.wanted >= low) & (found.wanted < high)]
        there = (found.matrix.frequency >= low) & (found.matrix.frequency < high)
        if not len(wanted):
            continue
        why = _reasons(found, wanted)
        if not there.any():
            nothing = (float("nan"),) * 3
            judged.append(Verdict(wanted[0], wanted[-1], "no value", why, 0, len(wanted), *nothing))
            continue
        tail = float(np.percentile(relative[there], 95))
        if tail > GOOD:
            doubtful = f"{np.count_nonzero(relative[there] > GOOD)} bins deviate by more than {100 * GOOD:g} %"
            why = f"{why}; {doubtful}" if why else doubtful
        median, coherent = float(np.median(relative[there])), float(np.median(coherence[there]))
        word = "usable" if why else "good"
        count = int(np.count_nonzero(there))
        judged.append(Verdict(wanted[0], wanted[-1], word, why, count, len(wanted), median, tail, coherent))
    return judged


def _reasons(found: Found, wanted: np.ndarray) -> str:
    """Return why lines of a band have no value, the most frequent reason first; nothing where all have one."""
    count: Counter[str] = Counter()
    for gap in found.gaps:
        count[gap.reason] += int(np.count_nonzero((wanted >= gap.low) & (wanted <= gap.high)))
    reasons = [(reason, lines) for reason, lines in count.most_common() if lines]
    if len(reasons) == 1 and reasons[0][1] == len(wanted):
        return reasons[0][0]
    return "; ".join(f"{lines} bins have no value, {reason}" for reason, lines in reasons)
