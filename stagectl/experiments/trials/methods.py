"""The methods by which a milled path is learned, a line each: what they know of the tool, and their law."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rigkit.learning_law import LearningLaw
from stagectl.experiments.trials.tool_path import ToolPath
from stagectl.robot.milling.learning import PathLaw, update
from stagectl.robot.milling.measured_cut import MeasuredCut
from stagectl.robot.milling.step_size import heeding


@dataclass(frozen=True, eq=False)
class Milled:
    """Trials of a path that are learned from, one after another.

    Parameters
    ----------
    wanted : array, shape (N, 3), m
        r.
    sent : sequence of arrays, shape (N, 3), m
        u, the paths sent.
    where : sequence of arrays, shape (N, 3), m
        y_n, as a method knows it.
    cuts : sequence of MeasuredCut or None
        How the cut answered along each; None where it is not known.
    air : (sequence, sequence) of arrays, shape (N, 3), m
        Paths sent in the air before, and where the tracker saw the tool there.
    seen : sequence of arrays, shape (N, 3), m
        y_n as the tracker saw it, of a method that does not learn from that; empty where it saw not all of the trials.
    """

    wanted: np.ndarray
    sent: Sequence[np.ndarray]
    where: Sequence[np.ndarray]
    cuts: Sequence[MeasuredCut | None]
    air: tuple[Sequence[np.ndarray], Sequence[np.ndarray]] = ((), ())
    seen: Sequence[np.ndarray] = ()


MillingLaw = LearningLaw[ToolPath, PathLaw, Milled, np.ndarray]
"""Asks for paths: array, shape (N, 3), m."""


class ByModels:
    """Begins with the path that is wanted; the next one takes the error away as the models say.

    Source
    ------
    Sörnmo 2015, eqs (5.8) and (5.11).
    """

    def first(self, model: ToolPath) -> np.ndarray:
        """Return r, shape (N, 3), m."""
        return model.wanted

    def next(self, belief: PathLaw, trial: Milled) -> np.ndarray:
        """Return u + Q L (I - G_K G_M) e, shape (N, 3), m, and no more than the steps so far have proved right.

        After the first trial in material those are the ones in the air: what sticks, or has backlash, is the same.
        Of a method that does not know the tool's place by the tracker, the tracker is asked beside what it learns from.
        """
        error = trial.wanted - trial.where[-1]
        heeded = heeding(belief, trial.sent, trial.where, trial.cuts, error)
        if len(trial.seen) > 1:
            heeded = heeding(heeded, trial.sent, trial.seen, trial.cuts, trial.wanted - trial.seen[-1])
        if len(trial.sent) == 1 and len(trial.air[0]) > 1:
            proved = heeding(replace(belief, process=None, caution=None), *trial.air).caution
            assert proved is not None
            heeded = belief.more_cautious(*proved)
        return update(trial.sent[-1], error, heeded, trial.cuts[-1])


@dataclass(frozen=True)
class Method:
    """What an error is made of, and what is learned from it.

    Parameters
    ----------
    side : "tool" or "motors"
        Which G_R it inverts: the one to what its error is made of.
    force : "measured", "estimated", or empty
        Which force its process model belongs to; empty in the air.
    is_by_force : bool
        Whether it knows of the tool's place by the force on it.
    law : MillingLaw
    """

    side: str
    force: str = ""
    is_by_force: bool = False
    law: MillingLaw = ByModels()


FREE_SPACE = Method("tool")
METHODS = {
    1: Method("tool", "measured"),
    2: Method("motors", "measured", is_by_force=True),
    3: Method("motors", "estimated", is_by_force=True),
}
"""By the number that `--method` names; their errors are those of `trial_error.METHODS`."""


def method_of(number: int | None) -> Method:
    """Return a method by its number; None is free space."""
    return FREE_SPACE if number is None else METHODS[number]
