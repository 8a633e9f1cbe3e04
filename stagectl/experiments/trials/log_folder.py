"""Logs of a trial that was run elsewhere: CSV files of angles, torques, tracker and force, brought to one time."""

import csv
from pathlib import Path

import numpy as np

from rigkit import atomic
from stagectl.experiments.trials.done import DoneTrial
from stagectl.experiments.trials.recorded import REFERENCE, TORQUE
from stagectl.experiments.trials.signals import ANGLE, NO_TORQUES, rest, tracker_log
from stagectl.experiments.trials.tool_path import RATE
from stagectl.experiments.trials.trial import Trial
from stagectl.robot.milling.alignment import on_grid, shift
from stagectl.robot.milling.axis_model import AxisModel, robot_response
from stagectl.robot.milling.trial_error import TrialSignals
from stagectl.robot.milling.zero_phase import filtered

ROBOT, TRACKER, FORCE, SENT = "robot.csv", "tracker.csv", "force.csv", "sent.csv"
ANGLES = tuple(f"angle_{joint}" for joint in range(1, 7))
TORQUES = tuple(f"torque_{joint}" for joint in range(1, 7))
REFERENCES = tuple(f"reference_{joint}" for joint in range(1, 7))
POSITION, FORCES = ("x", "y", "z"), ("fx", "fy", "fz")
MOST = 5.0
"""s by which clocks are looked for apart."""


def read_log(path: Path, columns: tuple[str, ...], optional: tuple[str, ...] = ()) -> dict[str, np.ndarray]:
    """Read columns of a CSV file, `time` (s) among them; units as the folder's page says.

    Parameters
    ----------
    path : Path
    columns : tuple of str
        That must be there, beside `time`.
    optional : tuple of str
        That may be there, all of them or none.

    Raises
    ------
    ValueError : no such file, a column that is missing, or a cell that is no number; with line and value.
    """
    try:
        with path.open(newline="", encoding="utf-8") as file:
            head, *lines = csv.reader(file)
    except (OSError, ValueError, csv.Error) as fault:
        raise ValueError(f"{path}: {fault}") from None
    names = [each.split("[")[0].strip() for each in head]
    wanted = ["time", *columns, *(optional if set(optional) <= set(names) else ())]
    if missing := [each for each in wanted if each not in names]:
        raise ValueError(f"{path}: there is no column {', '.join(missing)}; there are {', '.join(names)}")
    places = [names.index(each) for each in wanted]
    found = np.empty((len(lines), len(wanted)))
    for number, line in enumerate(lines, start=2):
        try:
            found[number - 2] = [float(line[place]) for place in places]
        except (ValueError, IndexError):
            raise ValueError(
                f"{path}: line {number} is {','.join(line)[:60]}, must be numbers under {', '.join(head)}"
            ) from None
    return dict(zip(wanted, found.T, strict=True))


class LogFolder:
    """The logs of one trial.

    `sent.csv` has the path that was sent (m in the workpiece, 250 a second, as a trial's own), `robot.csv` the motors'
    angles (rad) and, if they are to be used, torques (N m), `tracker.csv` the tool's position (m, in axes of the base)
    and `force.csv` the force on the tool (N, in axes of the base).  Every file has a `time` (s) of its own clock.

    The robot's log is brought to the path by the references in it (`reference_1` ..., rad), or else by what the model
    makes of the path, to a few ms; the tracker's to the robot's by its motion, or by `apart` where that is given, as it
    was in the air: in a cut the tool lags.  The force's clock must be the robot's.

    Parameters
    ----------
    path : Path
    first : Trial
        The first trial of the path.
    axes : tuple of AxisModel
        G_R to the motors' angles.

    Raises
    ------
    ValueError : a log that is missing, that has a gap, or that does not reach.
    """

    def __init__(self, path: Path, first: Trial, axes: tuple[AxisModel, ...]) -> None:
        self.path, self._first, self._gap = path, first, first.cell.learning.gap
        self.zero = first.seen_origin
        self.apart: float | None = None
        sent = read_log(path / SENT, POSITION)
        self.sent = np.stack([sent[name] for name in POSITION], axis=-1)
        if self.sent.shape != first.path.wanted.shape:
            raise ValueError(
                f"{path / SENT} has {len(self.sent)} samples, must be {first.path.samples} as the path has"
            )
        self._grid = np.arange(len(self.sent)) / RATE
        robot = read_log(path / ROBOT, ANGLES, TORQUES) | read_log(path / ROBOT, ANGLES, REFERENCES)
        self._robot_late = self._late(robot, axes)
        self.angle = self._sampled(robot, ANGLES, self._robot_late, ROBOT)
        self._torque = self._sampled(robot, TORQUES, self._robot_late, ROBOT) if TORQUES[0] in robot else None

    @property
    def torques(self) -> tuple[np.ndarray, np.ndarray]:
        """Motors' angles (rad) and torques (N m), shapes (N, 6); ValueError where none were logged."""
        if self._torque is None:
            raise ValueError(f"{self.path / ROBOT} has no column {', '.join(TORQUES)}: method 3 needs the torques")
        return self.angle, self._torque

    def signals(self, needs_tracker: bool, needs_force: bool) -> TrialSignals:
        """Return what the logs say, of tracker and force sensor where they are needed.

        Parameters
        ----------
        needs_tracker, needs_force : bool
        """
        first = self._first
        joints = first.path.in_workpiece(first.arm, self.angle)
        seen = self._seen(joints) if needs_tracker else None
        force = None
        if needs_force:
            force = self._sampled(read_log(self.path / FORCE, FORCES), FORCES, self._robot_late, FORCE)
        return TrialSignals(self.sent, joints, seen, force)

    def touch_off(self) -> np.ndarray:
        """Take where the tracker sees the tool at rest as where it is wanted; return where its origin is, (3,), m."""
        first = self._first
        off = (self._seen(first.path.in_workpiece(first.arm, self.angle)) - first.path.wanted)[rest(first)]
        self.zero = self.zero + off.mean(axis=0)
        return self.zero

    def _late(self, robot: dict[str, np.ndarray], axes: tuple[AxisModel, ...]) -> float:
        """Return when the path begins on the robot's clock, s."""
        time = robot["time"]
        even = np.arange(time[0], time[-1], 1.0 / RATE)
        names = REFERENCES if REFERENCES[0] in robot else ANGLES
        angle = np.stack([robot[name] for name in names], axis=-1)
        there = self._first.path.in_workpiece(
            self._first.arm, on_grid(time, angle, even, self._gap, str(self.path / ROBOT))
        )
        if names == REFERENCES:
            return float(time[0] + shift(self.sent, there, RATE, MOST))
        model = filtered(self.sent, RATE, lambda frequency: robot_response(axes, frequency))
        return float(time[0] + shift(model, there, RATE, MOST))

    def _seen(self, joints: np.ndarray) -> np.ndarray:
        """Return where the tracker saw the tool, in the workpiece; its clock is shifted to that of the motors."""
        log = read_log(self.path / TRACKER, POSITION)
        time, place = log["time"], np.stack([log[name] for name in POSITION], axis=-1)
        even = np.arange(time[0], time[-1], 1.0 / RATE)
        if self.apart is None:
            seen = on_grid(time, place, even, self._gap, str(self.path / TRACKER))
            self.apart = float(time[0] + shift(joints, seen, RATE, MOST)) - self._robot_late
        late = self._robot_late + self.apart
        return np.asarray(self._sampled(log, POSITION, late, TRACKER) - self.zero)

    def _sampled(self, log: dict[str, np.ndarray], columns: tuple[str, ...], late: float, name: str) -> np.ndarray:
        values = np.stack([log[column] for column in columns], axis=-1)
        return on_grid(log["time"] - late, values, self._grid, self._gap, str(self.path / name))


def write_path(path: Path, sent: np.ndarray, joints: np.ndarray) -> None:
    """Write a path as `sent.csv` has it, with its joint angles beside.

    Parameters
    ----------
    path : Path
    sent : array, shape (N, 3), m
    joints : array, shape (N, 6), rad
    """
    time = np.arange(len(sent)) / RATE
    _write(path, ("time [s]", *(f"{name} [m]" for name in POSITION), *(f"{name} [rad]" for name in ANGLES)), (
        time, sent, joints,
    ))  # fmt: skip


def write_logs(folder: Path, done: DoneTrial) -> None:
    """Write a trial's logs as other robots' are read: a folder for `--from`.

    Parameters
    ----------
    folder : Path
        Made if it is not there.
    done : DoneTrial
    """
    folder.mkdir(parents=True, exist_ok=True)
    own = done.records["trial"]
    time = np.arange(len(own.data)) / RATE
    write_path(folder / SENT, done.trial.sent, done.trial.joints)
    kept = [(ANGLES, "rad", ANGLE), (REFERENCES, "rad", REFERENCE)]
    if NO_TORQUES not in own.provenance:
        kept.insert(1, (TORQUES, "N m", TORQUE))
    head = [f"{name} [{unit}]" for names, unit, _ in kept for name in names]
    _write(folder / ROBOT, ("time [s]", *head), (time, *(own.select(each.channels).data for *_, each in kept)))
    _write(folder / TRACKER, ("time [s]", *(f"{name} [m]" for name in POSITION)), tracker_log(done.records))
    assert done.signals.force is not None
    _write(folder / FORCE, ("time [s]", *(f"{name} [N]" for name in FORCES)), (time, done.signals.force))


def _write(path: Path, head: tuple[str, ...], columns: tuple[np.ndarray, ...]) -> None:
    table = np.column_stack(columns)
    lines = [",".join(head), *(",".join(repr(float(each)) for each in row) for row in table)]
    atomic.write(path, "\n".join(lines) + "\n")
