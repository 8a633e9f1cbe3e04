"""`calibrate milling` from its first motion to its models: chirps, sweep, free space, the first trial in material."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from calibration.milling.chirp_path import ChirpPath
from calibration.milling.process_fit import ProcessFit, fit_process, refuse_short
from calibration.milling.robot_fit import AxisFit, fit_axis
from calibration.milling.sweep_session import sweep_path
from calibration.milling.torque_fit import TorqueFit, friction_and_gravity, known_speeds
from calibration.names import raw_folder
from calibration.output import Output, Wish, output
from calibration.raw_run import raw_run
from ctlblocks.recording import Recording
from ctlblocks.room import bytes_of
from rigkit.agreement import GOING_ON
from rigkit.disk_space import require
from rigkit.run_folder import RunFolder
from stagectl.experiments.trials.campaign import FIRST, carried_out, learn_free_space
from stagectl.experiments.trials.done import DoneTrial
from stagectl.experiments.trials.experiment import room
from stagectl.experiments.trials.joint_speeds import refuse_unknown_speeds
from stagectl.experiments.trials.laws import Forces, Learner
from stagectl.experiments.trials.signals import tracker_late
from stagectl.experiments.trials.tool_path import RATE
from stagectl.experiments.trials.trial import Trial, first_trial, in_the_air
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.force_model import ForceModel
from stagectl.robot.milling.milling_models import FORCES, SIDES, MillingModels, RobotModel
from stagectl.robot.milling.torque_file import torque_arrays
from stagectl.robot.milling.trial_error import kinematic_error

CHIRPS = "chirps"
LIVE, SIMULATED = "live", "simulated"
KEPT = GOING_ON.without(
    "clamping", "midranging", "toroid", "feedback", "segments", "feed_plants", "force", "force_estimate", "link"
)
"""What an unfinished one must have kept."""
SWEPT_CHANNELS = 24
"""Of the sweep's record, at most: reference, angle, torque and velocity of six joints."""


@dataclass(frozen=True, eq=False)
class Calibrated:
    """What came of it.

    Parameters
    ----------
    models : MillingModels
    axes : dict of str to list of AxisFit
        By side.
    processes : dict of str to ProcessFit
        By force.
    torques : TorqueFit
        Gravity and friction.
    forces : Forces
        From motors' torques, by these.
    free : list of DoneTrial
    milled : DoneTrial
    notes : tuple of str
        What is to be said: what could not be found, and what that means.
    """

    models: MillingModels
    axes: dict[str, list[AxisFit]]
    processes: dict[str, ProcessFit]
    torques: TorqueFit
    forces: Forces
    free: list[DoneTrial]
    milled: DoneTrial
    notes: tuple[str, ...] = ()


def output_of(
    out: Path, cell: CellConfig, wish: Wish, is_live: bool = False, read: Path | None = None
) -> Output[CellConfig]:
    """Say what a calibration of milling may write.

    Parameters
    ----------
    out : Path
    cell : CellConfig
    wish : Wish
    is_live : bool
        Whether it is of a robot behind its wires.
    read : Path, optional
        The rig file, which is no result.

    Raises
    ------
    ValueError : the name is taken, or unfinished with other settings or on the other cell.
    """
    kind = f"calibration of milling, {LIVE if is_live else SIMULATED}"
    return output(out, kind, cell, wish, [out.with_suffix(".html")], KEPT, inputs=[read])


@contextmanager
def raw_trials(writes: Output[CellConfig]) -> Iterator[RunFolder]:
    """Make the folder of a model file's raw recordings, or take it up again; one in which nothing came goes again."""
    with writes.begun(), raw_run(writes.raw, writes.config) as folder:
        yield folder


def require_room(out: Path, cell: CellConfig, task: str) -> None:
    """Refuse, by a `DiskFault`, a calibration that the disk has no room for beside what it has recorded.

    Parameters
    ----------
    out : Path
        Of the model.
    cell : CellConfig
    task : str
    """
    folder, chirps = raw_folder(out), in_the_air(cell, chirp_path(cell).path(cell.pocket))
    there = sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())
    swept = bytes_of(len(sweep_path(cell)), SWEPT_CHANNELS, "float64", "wav")
    needed = swept + room(chirps, 1) + room(first_trial(cell, task), cell.learning.free + 2)
    require(folder, max(needed - there, 0), "the recordings")


def chirp_path(cell: CellConfig) -> ChirpPath:
    """Return the chirps of a cell's file."""
    learning, chirp = cell.learning, cell.chirp
    stop = 1.1 * learning.highest
    return ChirpPath(cell.pocket.feed, chirp.share, chirp.largest, chirp.seconds, chirp.start, stop, chirp.height)


def fit_robot(cell: CellConfig, done: DoneTrial) -> dict[str, list[AxisFit]]:
    """Fit G_R of every direction, to the motors' angles and to the tool."""
    chirps, signals = chirp_path(cell), done.signals
    assert signals.seen is not None
    found: dict[str, list[AxisFit]] = {}
    for side, answer in zip(SIDES, (signals.joints, signals.seen), strict=True):
        found[side] = []
        for axis in range(3):
            parts = [chirps.part(cell.pocket, axis, held_back) for held_back in (False, True)]
            drives, answers = (
                tuple(_deviation(chirps, each[part, axis], number) for number, part in enumerate(parts))
                for each in (signals.sent, answer)
            )
            found[side].append(fit_axis(drives, answers, RATE, cell.learning.highest, cell.learning.cutoff))
    return found


def _deviation(chirps: ChirpPath, along: np.ndarray, number: int) -> np.ndarray:
    """Return what is beside the steady feed of a pass, shape (N,), m."""
    left = along - chirps.slope(bool(number)) * np.arange(len(along)) / RATE
    return np.asarray(left - left[: chirps.before].mean())


def robot_model(fits: list[AxisFit]) -> RobotModel:
    """Return the model of the three directions."""
    return RobotModel(
        tuple(each.model for each in fits),
        fits[0].frequency,
        np.stack([each.measured for each in fits], axis=-1),
        np.stack([each.spread for each in fits], axis=-1),
        np.array([each.fresh for each in fits]),
    )


def fit_milling(learner: Learner, milled: DoneTrial, note: Callable[[str], object]) -> dict[str, ProcessFit]:
    """Fit G_M and G_K, with the force as measured, and as estimated where torques tell it.

    Parameters
    ----------
    learner : Learner
    milled : DoneTrial
    note : callable(str)
        Told why the latter is left out.
    """
    signals = milled.signals
    assert signals.seen is not None
    assert signals.force is not None
    deflection = signals.seen - signals.joints - kinematic_error([each.signals for each in learner.free])
    forces = {FORCES[0]: signals.force}
    if learner.forces is not None:
        try:
            forces[FORCES[1]] = learner.estimated(milled)
        except ValueError as fault:
            note(f"there are no models of the force from torques, method 3 cannot be used: {fault}")
    inside = milled.trial.path.milled
    return {name: fit_process(signals.seen, deflection, force, inside, RATE) for name, force in forces.items()}


def calibrate(
    cell: CellConfig,
    task: str,
    run: Callable[[str, Trial], DoneTrial],
    swept: Recording,
    words: Mapping[str, str],
) -> Calibrated:
    """Run all trials and fit all models.

    Parameters
    ----------
    cell : CellConfig
    task : str
    run : callable
        Runs a trial under a name.
    swept : Recording
        Of the workspace sweep.
    words : mapping of str to str
        The models' own.
    """
    chirps, first = in_the_air(cell, chirp_path(cell).path(cell.pocket)), first_trial(cell, task)
    friction, gravity, torques = friction_and_gravity(swept, first.arm, cell.friction)
    settings = cell.force_estimate
    forces = ForceModel(first.arm, gravity, friction, torques.inertia, settings.tie_break, settings.margin)
    chirped = run(CHIRPS, chirps)
    late = tracker_late(chirped.trial, chirped.records)
    axes = fit_robot(cell, DoneTrial(CHIRPS, replace(chirped.trial, late=late), chirped.records))
    about = {**words, "task": task}
    robot = {side: robot_model(fits) for side, fits in axes.items()}
    models = MillingModels(robot, {}, first.path.pocket.depth, torque_arrays(friction, gravity, torques.inertia), about)

    def told(angle: np.ndarray, torque: np.ndarray) -> np.ndarray:
        return forces.estimate(angle, torque, RATE).force

    learner = Learner(cell, models, told)
    milled = run(FIRST, carried_out(learn_free_space(first, learner), run))
    notes = [torques.note] if torques.note else []
    processes = fit_milling(learner, milled, notes.append)
    whole = replace(models, process={name: each.process for name, each in processes.items()})
    return Calibrated(whole, axes, processes, torques, told, learner.free, milled, tuple(notes))


def refuse_unfit_path(cell: CellConfig, first: Trial) -> None:
    """Refuse, before anything moves, a path from which the models cannot be had, by ValueError.

    Parameters
    ----------
    cell : CellConfig
    first : Trial
        The first trial of the path.
    """
    refuse_short(first.path.milled, RATE)
    smoothing = cell.friction.smoothing
    known = known_speeds(sweep_path(cell), RATE, smoothing)
    refuse_unknown_speeds(first, known, smoothing, "a sweep by [friction]")


def motion_seconds(cell: CellConfig, task: str) -> float:
    """Return how long all motions take together, s, beside ways to a trial and people.

    Parameters
    ----------
    cell : CellConfig
    task : str
    """
    trials = (cell.learning.free + 2) * first_trial(cell, task).path.samples
    return (len(sweep_path(cell)) + chirp_path(cell).path(cell.pocket).samples + trials) / RATE


def dry_run(cell: CellConfig, task: str) -> list[str]:
    """Return in words all that moves, in order, but the sweep.

    Parameters
    ----------
    cell : CellConfig
    task : str

    Raises
    ------
    ValueError : a path that the robot does not reach, that is in the material too shortly, or on which a joint is
        faster than its friction will be known.
    """
    chirps, first = chirp_path(cell), first_trial(cell, task)
    refuse_unfit_path(cell, first)
    path, free = first.path, cell.learning.free + 1
    lowest, highest = (1e3 * each(path.wanted, axis=0) for each in (np.min, np.max))
    return [
        f"chirps {chirps.start:g} to {chirps.stop:g} Hz along x, y and z, up to {1e3 * chirps.largest:g} mm on a feed "
        f"of {1e3 * chirps.feed:g} mm/s, {1e3 * chirps.height:g} mm above the workpiece: "
        f"{chirps.path(cell.pocket).samples / RATE:.0f} s",
        f"{free} air cuts, x {lowest[0]:.0f} to {highest[0]:.0f}, y {lowest[1]:.0f} to {highest[1]:.0f}, "
        f"z {lowest[2]:.0f} to {highest[2]:.0f} mm in the workpiece: {path.samples / RATE:.1f} s each",
        f"a trial in material, {1e3 * path.pocket.depth:g} mm deep: {path.samples / RATE:.1f} s",
    ]
