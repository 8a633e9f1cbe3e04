"""From a trial's recordings to the signals that are learned from, all at the trial's own samples."""

from collections.abc import Mapping

import numpy as np

from ctlblocks.recording import Recording
from stagectl.devices.signals import ROBOT
from stagectl.experiments.trials.recorded import FELT, FOLLOW, LOGGED, MADE, TORQUE, TRUTH
from stagectl.experiments.trials.tool_path import RATE
from stagectl.experiments.trials.trial import Trial
from stagectl.robot.milling.alignment import on_grid, shift
from stagectl.robot.milling.trial_error import TrialSignals

BEFORE = 0.1
"""s before the path begins that are not counted as rest."""
ANGLE = next(signal for signal in ROBOT if signal.name == "motor_angle")
STAMP = "stamp"
NO_TORQUES = "no_torques"
"""In the provenance of a live recording of version 0.1.0: why its torques are none."""
LATEST = 0.2
"""s by which the tracker's clock may be behind the robot's, after the quickest messages of both."""


def signals_of(trial: Trial, records: Mapping[str, Recording], force: np.ndarray | None = None) -> TrialSignals:
    """Return the signals of a trial that ran to its end.

    Parameters
    ----------
    trial : Trial
    records : mapping of str to Recording
        `trial` and `tracker`.
    force : array, shape (N, 3), N, optional
        Estimated; the measured one where not given.

    Raises
    ------
    ValueError : gaps in what the tracker saw.
    """
    own = records["trial"]
    count = len(own.data)
    joints = trial.path.in_workpiece(trial.arm, own.select(ANGLE.channels).data)
    felt = own.select(FELT.channels).data if force is None else force
    return TrialSignals(trial.sent[:count], joints, tool_seen(trial, records["tracker"], count), tared(trial, felt))


def tool_seen(trial: Trial, tracker: Recording, count: int) -> np.ndarray:
    """Return where the tracker saw the tool, at the times when it was there: shape (count, 3), m, in the workpiece.

    Parameters
    ----------
    trial : Trial
    tracker : Recording
    count : int, samples
    """
    stamp, seen = tracker_log({"tracker": tracker})
    grid, patience = np.arange(count) / RATE, trial.cell.learning.gap
    return np.asarray(on_grid(stamp - trial.late, seen, grid, patience, "the tracker") - trial.seen_origin)


def tracker_log(records: Mapping[str, Recording]) -> tuple[np.ndarray, np.ndarray]:
    """Return when the tracker saw the tool, s, shape (samples,), and where, m in its own axes, shape (samples, 3).

    Parameters
    ----------
    records : mapping of str to Recording
    """
    tracker = records["tracker"]
    seen = tracker.select(MADE["tracker"][0].channels).data
    new = np.flatnonzero((np.diff(seen, axis=0) != 0).any(axis=1)) + 1
    return tracker.select([STAMP]).data[new, 0], seen[new]


def tracker_late(trial: Trial, records: Mapping[str, Recording]) -> float:
    """Return by how much later than the motors the tracker has the tool, s, in the air; 0 where they have one clock.

    A real tracker's clock is brought to the robot's by the messages that came quickest, so what is left is how long it
    looks and thinks: found by the motion, as of logs.  In the simulated cell a time stamp is exact.

    Parameters
    ----------
    trial : Trial
    records : mapping of str to Recording
    """
    if "truth" in records:
        return 0.0
    own = records["trial"]
    joints = trial.path.in_workpiece(trial.arm, own.select(ANGLE.channels).data)
    return shift(joints, tool_seen(trial, records["tracker"], len(joints)), RATE, LATEST)


def touched_off(trial: Trial, records: Mapping[str, Recording]) -> np.ndarray:
    """Return where the tracker sees the workpiece's origin, shape (3,), m, from where it sees the tool at rest.

    Parameters
    ----------
    trial : Trial
        Whose path begins where the tool is wanted.
    records : mapping of str to Recording
    """
    seen = tool_seen(trial, records["tracker"], len(records["trial"].data))
    return np.asarray(trial.seen_origin + (seen - trial.path.wanted)[rest(trial)].mean(axis=0))


def tared(trial: Trial, force: np.ndarray) -> np.ndarray:
    """Return a force less what it is on average at rest before the path, shape (N, 3), N.

    Its zero is taken in the beginning of that rest, which does not count.

    Parameters
    ----------
    trial : Trial
    force : array, shape (N, 3), N
    """
    still = rest(trial)
    known = max(still.start, round((trial.cell.force_sensor.rest + BEFORE) * RATE))
    return np.asarray(force - force[min(known, still.stop - 1) : still.stop].mean(axis=0))


def rest(trial: Trial) -> slice:
    """Return which samples of a trial are at rest before its path."""
    return slice(round(FOLLOW * RATE), round((trial.cell.pocket.lead - BEFORE) * RATE))


def truth(trial: Trial, records: Mapping[str, Recording]) -> np.ndarray | None:
    """Return where the simulated tool really was, shape (N, 3), m, in the workpiece; None of a live trial.

    Parameters
    ----------
    trial : Trial
    records : mapping of str to Recording
    """
    if "truth" not in records:
        return None
    return np.asarray(records["truth"].select(TRUTH[0].channels).data - trial.path.origin(trial.arm))


def touched_block(trial: Trial, records: Mapping[str, Recording]) -> np.ndarray | None:
    """Return where the simulated workpiece's origin is, shape (3,), m, from where the tool at rest is; None live.

    Parameters
    ----------
    trial : Trial
        Whose path begins where the tool is wanted.
    records : mapping of str to Recording
    """
    where = truth(trial, records)
    if where is None:
        return None
    off = where - trial.path.wanted[: len(where)]
    return np.asarray(trial.path.origin(trial.arm) + off[rest(trial)].mean(axis=0))


def torque_log(trial: Trial, records: Mapping[str, Recording]) -> tuple[np.ndarray, np.ndarray]:
    """Return motor angles (rad) and torques (N m) of a trial, shapes (N, 6); torques of a line of their own in time.

    Parameters
    ----------
    trial : Trial
    records : mapping of str to Recording

    Raises
    ------
    ValueError : a live trial without torques, or with a gap in them.
    """
    own, beside = records["trial"], records["tracker"]
    if NO_TORQUES in own.provenance:
        raise ValueError(own.provenance[NO_TORQUES])
    angle = own.select(ANGLE.channels).data
    stamped, logged = LOGGED
    if stamped.name not in beside.names:
        return angle, own.select(TORQUE.channels).data
    stamp = beside.select(stamped.channels).data[:, 0]
    new = np.flatnonzero(np.diff(stamp) != 0) + 1
    if not len(new):
        raise ValueError("no motor torques arrive")
    torque = beside.select(logged.channels).data[new]
    grid = np.arange(len(angle)) / RATE
    return angle, on_grid(stamp[new], torque, grid, trial.cell.learning.gap, "the torque signals")
