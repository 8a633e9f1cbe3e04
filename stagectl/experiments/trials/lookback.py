"""A look back after each trial: what made the work worse is not gone on from."""

from dataclasses import dataclass, replace

import numpy as np

from stagectl.experiments.trials.done import DoneTrial
from stagectl.robot.milling.trial_error import mae

WORSE = 1.2
"""Times the least error so far, from which on a trial has made it worse: trials of one path differ by less."""
BLOCKS = 0.05
"""Part of an error by which it may differ between two blocks: more than that over the uncompensated one is no gain."""
PARTS = (1.0, 0.5, 0.25)
"""Of a step: each time that one has made it worse the next part is tried, from the best path; then learning ends."""


@dataclass(frozen=True, eq=False)
class Step:
    """A path to be sent next, and where the tool is foreseen to come.

    Parameters
    ----------
    before, sent : arrays, shape (N, 3), m
        u_k and u_{k+1}.
    where, come : arrays, shape (N, 3), m
        y_n of trial k, and as it is foreseen of the next, by (5.10).
    wanted : array, shape (N, 3), m
        r.
    milled : array, shape (N,)
        Which samples count.
    witnessed : float, 0 to 1
        Part of the law's correction that it is: no more than what makes smaller the errors that a tracker saw.
    """

    before: np.ndarray
    sent: np.ndarray
    where: np.ndarray
    come: np.ndarray
    wanted: np.ndarray
    milled: np.ndarray
    witnessed: float = 1.0

    @property
    def foreseen(self) -> float:
        """Euclidean norm of the mean absolute errors that are foreseen, m."""
        return float(np.linalg.norm(mae((self.wanted - self.come)[self.milled])))

    def part(self, share: float) -> "Step":
        """Return that part of it."""
        sent, come = self.before + share * (self.sent - self.before), self.where + share * (self.come - self.where)
        return replace(self, sent=sent, come=come)


def size(done: DoneTrial) -> float:
    """Return the Euclidean norm of a trial's mean absolute errors, m, up to where learning acts."""
    return float(np.linalg.norm(done.slow_mae))


class Lookback:
    """Which trials of a method are gone on from, and how large a step is made.

    Parameters
    ----------
    first : DoneTrial
        Iteration 0.
    """

    def __init__(self, first: DoneTrial) -> None:
        self.kept, self._tried = [first], 0

    @property
    def share(self) -> float:
        """Part of the step that is made next."""
        return PARTS[self._tried]

    def take(self, done: DoneTrial) -> str:
        """Take a trial that was run; return what is to be said where it made the work worse.

        Worse is what has `WORSE` times the least error so far, or more than iteration 0 by more than two blocks differ
        and the tracker's noise.  A step that did no harm leaves the share as it is: what halved it has not gone away.
        """
        first, least = self.kept[0], min(self.kept, key=size)
        doubt = np.hypot(BLOCKS * size(first), np.linalg.norm(done.slow_noise))
        if size(done) <= min(WORSE * size(least), size(first) + doubt):
            self.kept.append(done)
            return ""
        self._tried += 1
        self.kept = self.kept[: self.kept.index(least) + 1]
        said = f"{done.name}: {1e6 * size(done):.0f} µm, where {least.name} had {1e6 * size(least):.0f}"
        if self.is_over:
            return f"{said}: learning ends, the path of {least.name} is the best"
        return f"{said}: back to that path, with {self.share:g} of the step"

    @property
    def is_over(self) -> bool:
        """Whether no part of a step is left that has not made it worse."""
        return self._tried >= len(PARTS)
