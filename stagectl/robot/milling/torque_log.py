"""A signal logger's file of motor angles and torques: read, judged, and laid on an even grid with its gaps."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rigkit import os_fault
from rigkit.text_file import TextFault, read_text
from stagectl.robot.arm import Arm

JOINTS = range(1, 7)
NAMES = ("time", *(f"angle_{joint}" for joint in JOINTS), *(f"torque_{joint}" for joint in JOINTS))
"""Time (s), six angles, six torques (N m): the columns of a log, by these names or in this order."""
COLUMNS = len(NAMES)
LONGEST_GAP = 10.0
"""s; what is further apart does not belong together."""
OFF_GRID = 0.3
"""Of a sample: further off an even grid, times are not those of one clock."""
FULL_TURN = 2 * np.pi


class TorqueLogError(ValueError):
    """A log that cannot be used; names file, row and what is wrong."""


@dataclass(frozen=True, eq=False)
class TorqueLog:
    """Motor angles and torques on an even grid, seen from the joints' side.

    Parameters
    ----------
    time : array, shape (samples,), s
    joint_angle : array, shape (samples, 6), rad
    torque : array, shape (samples, 6), N m
        NaN, as the angles, where nothing was logged.
    rate : float, samples/s
    gaps : int
        How many stretches have nothing, or a number that is none.
    missing : int
        Samples in them.
    """

    time: np.ndarray
    joint_angle: np.ndarray
    torque: np.ndarray
    rate: float
    gaps: int
    missing: int


def read_torque_log(path: Path, arm: Arm, unit: str | None = None) -> TorqueLog:
    """Read a log: a line a sample of time (s), six angles and six torques (N m), with or without a row of names.

    Where the row of names has all of `NAMES`, columns go by them, others are left aside, and angles are in the unit
    that stands in brackets behind their names.  An empty cell, `nan` and lines that are missing are gaps.

    Parameters
    ----------
    path : Path
    arm : Arm
        Whose limits the angles must be in.
    unit : "deg" or "rad", optional
        Of the angles; without one it is that of the log's names, or degrees, as a signal logger writes them, and a log
        that could be in radians is refused.

    Raises
    ------
    TorqueLogError : no such file, a row that is none, time that does not rise or has no even step, a gap that is too
        long, angles beyond the arm's limits.
    """
    if unit not in (None, "deg", "rad"):
        raise TorqueLogError(f"the angles' unit is {unit!r}, must be deg or rad")
    rows, numbers, named = _rows(path)
    unit = unit or named
    time = rows[:, 0]
    if len(rows) < 3:
        raise TorqueLogError(f"{path}: has {len(rows)} samples, must have 3 at least")
    back = np.flatnonzero(~(np.diff(time) > 0))
    if len(back):
        before, after = time[back[0]], time[back[0] + 1]
        raise TorqueLogError(f"{path}: row {numbers[back[0] + 1]}: time goes from {before:g} to {after:g} s, must rise")
    place, step = _grid(path, time, numbers)
    found = np.full((int(place[-1]) + 1, COLUMNS - 1), np.nan)
    found[place] = rows[:, 1:]
    found[~np.isfinite(found).all(axis=1)] = np.nan
    lost = np.isnan(found[:, 0])
    if lost.all():
        raise TorqueLogError(f"{path}: no sample has all its numbers")
    if unit is None and np.abs(found[~lost, :6]).max() <= FULL_TURN:
        raise TorqueLogError(
            f"{path}: all angles are within +-6.28, are they in deg or in rad? Say --angles deg or rad"
        )
    angle = found[:, :6].copy() if unit == "rad" else np.radians(found[:, :6])
    _refuse_outside(path, arm, angle[~lost], unit or "deg")
    starts = int(np.sum(np.diff(lost.astype(int), prepend=0) == 1))
    grid = time[0] + step * np.arange(len(found))
    return TorqueLog(grid, angle, found[:, 6:].copy(), 1.0 / step, starts, int(lost.sum()))


def _rows(path: Path) -> tuple[np.ndarray, list[int], str | None]:
    """Return the numbers, NaN for cells that have none, the row of the file that each is in, from 1, and their unit."""
    try:
        text = read_text(path)
    except OSError as fault:
        raise TorqueLogError(os_fault.told(fault)) from None
    except TextFault as fault:
        raise TorqueLogError(str(fault)) from None
    found: list[list[float]] = []
    numbers: list[int] = []
    places, unit, width = list(range(COLUMNS)), None, COLUMNS
    for number, line in enumerate(text.splitlines(), start=1):
        cells = [cell.strip() for cell in line.split(",")]
        if not line.strip() or line.startswith("#"):
            continue
        if not found and (named := _by_name(path, cells)) is not None:
            (places, unit), width = named, len(cells)
            continue
        if len(cells) != width:
            raise TorqueLogError(
                f"{path}: row {number} has {len(cells)} columns, must have {width}: time (s), six angles, six "
                f"torques (N m), or these among others under the names {NAMES[0]}, {NAMES[1]} to {NAMES[-1]}"
            )
        cells = [cells[place] for place in places]
        if not found and not _is_number(cells[0]):
            continue  # names of others
        wrong = [cell for cell in cells if cell and not _is_number(cell)]
        if wrong or not cells[0]:
            raise TorqueLogError(f"{path}: row {number}: {(wrong or ['time'])[0]!r} is no number")
        found.append([float(cell) if cell else np.nan for cell in cells])
        numbers.append(number)
    rows = np.array(found).reshape(-1, COLUMNS)
    if not np.isfinite(rows[:, 0]).all():
        raise TorqueLogError(f"{path}: row {numbers[int(np.isfinite(rows[:, 0]).argmin())]}: time must be finite")
    return rows, numbers, unit


def _by_name(path: Path, cells: list[str]) -> tuple[list[int], str | None] | None:
    """Return where each of `NAMES` is, and the unit of the angles where it is said; None where one is missing."""
    heads = [cell.removesuffix("]").partition("[") for cell in cells]
    names = [name.strip() for name, _, _ in heads]
    if not set(NAMES) <= set(names):
        return None
    places = [names.index(name) for name in NAMES]
    angles, torques = ({heads[place][2] for place in part} for part in (places[1:7], places[7:]))
    if angles not in ({""}, {"deg"}, {"rad"}) or not torques <= {"", "N m"}:
        units = ", ".join(repr(unit) for unit in sorted(angles | torques))
        raise TorqueLogError(f"{path}: units are {units}, must be deg or rad for all angles and N m for all torques")
    return places, angles.pop() or None


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell  # float() takes 1_0


def _grid(path: Path, time: np.ndarray, numbers: list[int]) -> tuple[np.ndarray, float]:
    """Return at which sample of an even grid each row is, and the grid's step, s."""
    steps = np.diff(time)
    long = np.flatnonzero(steps > LONGEST_GAP)
    if len(long):
        raise TorqueLogError(
            f"{path}: row {numbers[long[0] + 1]}: a gap of {steps[long[0]]:.3g} s, must be <= {LONGEST_GAP:g} s; split "
            "the log there"
        )
    usual = float(np.median(steps))
    usual = float(np.mean(steps[np.abs(steps - usual) < OFF_GRID * usual]))
    counts = np.round(steps / usual)
    off = np.abs(steps - counts * usual)
    wrong = np.flatnonzero((counts < 1) | (off > OFF_GRID * usual))
    if len(wrong):
        raise TorqueLogError(
            f"{path}: row {numbers[wrong[0] + 1]}: time goes on by {steps[wrong[0]]:.4g} s, must by whole samples of "
            f"{usual:.4g} s"
        )
    return np.concatenate([[0], np.cumsum(counts).astype(int)]), usual


def _refuse_outside(path: Path, arm: Arm, angle: np.ndarray, unit: str) -> None:
    try:
        arm.refuse_outside(angle)
    except ValueError as fault:
        raise TorqueLogError(f"{path}: {fault}; angles are read in {unit}") from None
