"""What the guard of the robot's port would not let through of a path: told before it is run."""

import numpy as np

from stagectl.experiments.trials.tool_path import RATE
from stagectl.experiments.trials.trial import Trial
from stagectl.robot.guard import CommandGuard
from stagectl.robot.port import arm_of


def refuse_guarded(trial: Trial, sent: np.ndarray) -> None:
    """Refuse a path at which the guard would hold the robot in the cut: joints too fast, a limit passed.

    Parameters
    ----------
    trial : Trial
        Has the path that is wanted, the arm and the cell's limits.
    sent : array, shape (N, 3), m

    Raises
    ------
    ValueError : it would; with the time, and what the guard says.
    """
    guard = CommandGuard(arm_of(trial.cell), trial.cell.limits, "joints", trial.cell.robot.tool)
    nominal, wanted = (trial.path.joints(trial.arm, each) for each in (trial.path.wanted, sent))
    guard.place(wanted[0])
    guard.release()
    for tick, (before, after) in enumerate(zip(nominal, wanted, strict=True)):
        why = guard.take(before, after)
        if why:
            raise ValueError(f"at {tick / RATE:.3g} s {why}")
