"""Learning from the logs of one trial that was run elsewhere."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from stagectl.experiments.trials.laws import Learner, determined
from stagectl.experiments.trials.log_folder import FORCE, ROBOT, TRACKER, LogFolder, write_path
from stagectl.experiments.trials.methods import method_of
from stagectl.experiments.trials.tool_path import RATE
from stagectl.experiments.trials.trial import Trial
from stagectl.robot.milling.trial_error import kinematic_error
from stagectl.robot.milling.witness import refuse_other_axes, refuse_other_robot

AIR, NEXT = "free", "next.csv"
SAME = 1e-6
"""m, within which a path is one that was written to a file."""


def learn_from_logs(folder: Path, first: Trial, learner: Learner, method: int) -> Path:
    """Learn from the logs of one trial; write the path to send next into their folder, and return where.

    Lost motion that the first path has carried is taken out of the next one where the tracker denies it in the air.

    What the logs say is held against the models, and against each other: a force whose sign is reversed, or none, other
    units, swapped axes and clocks apart are refused by their likely reason.

    Parameters
    ----------
    folder : Path
        Logs of a trial in material; methods 2 and 3 need those of one in the air in its folder `free`, too.
    first : Trial
    learner : Learner
    method : int

    Raises
    ------
    ValueError : logs that are missing or refused, or as of `Learner.corrected`.
    """
    axes, kinematic = learner.models.robot["motors"].axes, None
    done = LogFolder(folder, first, axes)
    air = LogFolder(folder / AIR, first, axes) if (folder / AIR).is_dir() else None
    if air is None and method != 1:
        raise ValueError(f"{folder / AIR}/ is missing: method {method} needs the logs of an air cut")
    if air is not None:
        done.zero, done.apart = air.touch_off(), air.apart
        kinematic = kinematic_error([air.signals(True, False)])
    signals = done.signals(method == 1 or (folder / TRACKER).is_file(), method == 2)
    refuse_other_robot(signals.sent, signals.joints, axes, str(folder / ROBOT))
    if signals.seen is not None:
        refuse_other_axes(signals.seen, signals.joints, RATE, str(folder / TRACKER))
    if method == 3 and air is not None:
        told = [determined(learner.forces, *each.torques, str(each.path)) for each in (done, air)]
        signals = replace(signals, force=told[0] - told[1])
    if method_of(method).is_by_force and kinematic is not None:
        learner.refuse_other_force(signals, kinematic, method, first.path.milled, str(folder / FORCE))
    step = learner.corrected(first, [signals], method, kinematic)
    if step.witnessed == 0.0:
        raise ValueError(
            f"{folder / TRACKER}: nothing is to be won by what the logs show method {method}: its correction does "
            "not go with the errors that the tracker saw; learn by another method, or stay with this path"
        )
    sent = step.sent
    if learner.lost is not None:
        sent = sent - _denied(first, learner, method, done, air)
    write_path(folder / NEXT, sent, first.path.joints(first.arm, sent))
    return folder / NEXT


def _denied(first: Trial, learner: Learner, method: int, done: LogFolder, air: LogFolder | None) -> np.ndarray:
    """Return what is taken out of the next path again, shape (N, 3), m: lost motion that the tracker denies in the air.

    It is judged by the first path, in which nothing is learned yet, and not again by later ones.
    """
    assert learner.lost is not None
    path, none = first.path.wanted + learner.carried(first), np.zeros_like(first.path.wanted)
    if np.abs(done.sent - path).max() > SAME:
        return none
    if air is None or not (air.path / TRACKER).is_file():
        learner.note(f"{done.path / AIR}: no tracker saw the tool in the air: nothing judges what the path carries")
        return none
    why = learner.lost.refusal(first.arm, air.angle, air.signals(True, False), first.path.milled, RATE)
    if not why:
        return none
    learner.note(f"{air.path}: {why}")
    return learner.unlearned(first, method)
