"""The three error signals that a milled path is learned from: tracker, force sensor, or estimated force."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stagectl.robot.milling.learning import ProcessModel
from stagectl.robot.milling.measured_cut import MeasuredCut, cutting_gain
from stagectl.robot.milling.zero_phase import low_passed

METHODS = {
    1: "the tool as the tracker sees it",
    2: "motor angles and measured force",
    3: "motor angles and force estimated from motor torques",
}
"""What the error of each method is made of [Sörnmo 2015, sec. 5.2]."""


@dataclass(frozen=True, eq=False)
class TrialSignals:
    """What was measured in a trial, sample by sample beside the path that was sent; all in the workpiece's axes.

    Parameters
    ----------
    sent : array, shape (N, 3), m
        u, the path.
    joints : array, shape (N, 3), m
        y_r, the tool's position as the motors' angles have it.
    seen : array, shape (N, 3), m, or None
        y_n, the tool as the tracker sees it.
    force : array, shape (N, 3), N, or None
        On the tool, beyond what there is in the air: measured or estimated.
    """

    sent: np.ndarray
    joints: np.ndarray
    seen: np.ndarray | None = None
    force: np.ndarray | None = None


def kinematic_error(free: Sequence[TrialSignals]) -> np.ndarray:
    """Return d_e, by what the tool is beside where its motors' angles say, along a path in free space: shape (N, 3), m.

    Parameters
    ----------
    free : sequence of TrialSignals
        Trials in the air that the tracker saw; the mean of all counts.

    Raises
    ------
    ValueError : no trial, or none that was seen.
    """
    off = [each.seen - each.joints for each in free if each.seen is not None]
    if not off:
        raise ValueError("the tracker saw no air cut: the tool's path in free space is unknown")
    return np.asarray(np.mean(off, axis=0))


def tool_position(
    trial: TrialSignals, method: int, rate: float, process: ProcessModel | None, kinematic: np.ndarray | None
) -> np.ndarray:
    """Return y_n as a method knows it, shape (N, 3), m.

    Parameters
    ----------
    trial : TrialSignals
    method : int, of `METHODS`
        1: y_n as seen; 2 and 3: y_r + d_e + G_K f.
    rate : float, samples/s
    process : ProcessModel or None
        Methods 2 and 3 need it.
    kinematic : array, shape (N, 3), m, or None
        d_e; methods 2 and 3 need it.

    Raises
    ------
    ValueError : another method, or a signal that it needs and the trial has not.

    Source
    ------
    Sörnmo 2015, eqs (5.9) and (5.12).

    Departs
    -------
    (5.12) has d_e = 0.  But once free space is learned, it is y_r + d_e that follows the path, and y_r alone would show
    an error that is none; so what the tracker saw in the air is added.
    """
    if method not in METHODS:
        raise ValueError(f"method is {method}, must be {', '.join(map(str, METHODS))}")
    if method == 1:
        if trial.seen is None:
            raise ValueError("method 1 learns from what the tracker saw, but the trial has no such signal")
        return trial.seen
    if trial.force is None:
        needed = "a measured force" if method == 2 else "motor torques to estimate the force from"
        raise ValueError(f"method {method} needs {needed}, but the trial has none")
    if process is None or kinematic is None:
        raise ValueError(f"method {method} needs the models of force and compliance, and the trials in free space")
    return np.asarray(trial.joints + kinematic + process.deflection(trial.force, rate))


def measured_cut(
    trial: TrialSignals, method: int, rate: float, process: ProcessModel, kinematic: np.ndarray
) -> MeasuredCut:
    """Return how the cut answered to the tool's speed along a trial, as a method knows its force.

    Parameters
    ----------
    trial : TrialSignals
    method : int, of `METHODS`
        1: by how far the tracker saw the arm bent; 2 and 3: f, by which G_K bends it.
    rate : float, samples/s
    process : ProcessModel
    kinematic : array, shape (N, 3), m
        d_e.

    Raises
    ------
    ValueError : as `tool_position`.
    """
    where = tool_position(trial, method, rate, process, kinematic)
    if method == 1:
        return MeasuredCut(cutting_gain(where - trial.joints - kinematic, where, rate))
    assert trial.force is not None
    return MeasuredCut(cutting_gain(trial.force, where, rate), process.compliance)


def slow(error: np.ndarray, cutoff: float, rate: float) -> np.ndarray:
    """Return what errors have up to a frequency, without phase, shape (N, 3), m.

    Parameters
    ----------
    error : array, shape (N, 3), m
    cutoff : float, Hz
    rate : float, samples/s
    """
    return low_passed(error, rate, cutoff)


def mae(error: np.ndarray) -> np.ndarray:
    """Return the mean absolute error along each axis, shape (3,), m, of errors, shape (N, 3), m.

    Parameters
    ----------
    error : array, shape (N, 3), m

    Source
    ------
    Sörnmo 2015, eq. (5.14); Table 5.1 has the Euclidean norm of the three.
    """
    return np.asarray(np.abs(error).mean(axis=0))
