"""A trial before its first sample: which path is sent, through what, and what stands behind the port."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from stagectl.experiments.trials.pocket_path import pocket_path
from stagectl.experiments.trials.tool_path import ToolPath
from stagectl.robot.arm import Arm
from stagectl.robot.config import CellConfig
from stagectl.robot.live.guide import refuse_another_arm
from stagectl.robot.pocket_config import Pocket
from stagectl.robot.port import arm_of

TASKS: dict[str, dict[str, Any]] = {"pocket28": {}, "pocket28-deep": {"depth": 4e-3}, "pocket": {}}
"""What `--task` takes, and what it changes of `[pocket]`: the thesis' two pockets, and the one of the file."""

BLOCKS = 1_000
"""Blocks of a simulated machine: each trial mills another."""


@dataclass(frozen=True, eq=False)
class Trial:
    """One run along the path.

    Parameters
    ----------
    cell : CellConfig
        As `cell_of` gives it.
    path : ToolPath
        Where the tool is wanted.
    number : int
        Counts all trials; noise differs by it, the simulated machine does not.
    sent : array, shape (N, 3), m
        u, the path in the workpiece.
    is_milled : bool
        Whether there is a workpiece; else the tool runs in the air.
    zero : array, shape (3,), m, optional
        Where the tracker sees the workpiece's origin; where its gateway and the robot agree if not given.
    block : array, shape (3,), m, optional
        Where the simulated workpiece's origin is in the base: it is touched off with the tool as the arm bends.
    late : float, s
        By how much later than the motors the tracker has the tool.
    foreseen : float, m
        Norm of its errors as the trial before has it foreseen; 0 where nothing was.
    """

    cell: CellConfig
    path: ToolPath
    number: int
    sent: np.ndarray
    is_milled: bool
    zero: np.ndarray | None = None
    block: np.ndarray | None = None
    late: float = 0.0
    foreseen: float = 0.0

    @cached_property
    def arm(self) -> Arm:
        """The robot, to its tool point."""
        return tool_arm(self.cell)

    @cached_property
    def joints(self) -> np.ndarray:
        """Of the path sent, shape (N, 6), rad."""
        return self.path.joints(self.arm, self.sent)

    @property
    def seen_origin(self) -> np.ndarray:
        """Where the tracker sees the workpiece's origin, shape (3,), m."""
        return self.path.origin(self.arm) if self.zero is None else self.zero

    def again(self, sent: np.ndarray, is_milled: bool, foreseen: float = 0.0) -> "Trial":
        """Return the next one, with another path."""
        return replace(self, number=self.number + 1, sent=sent, is_milled=is_milled, foreseen=foreseen)

    @property
    def about(self) -> dict[str, str]:
        """What is to be known of it beside its recordings, and `trial_of` reads: provenance of theirs."""
        told = {"number": str(self.number), "milled": str(int(self.is_milled)), "late": repr(self.late)}
        if self.foreseen:
            told["foreseen"] = repr(self.foreseen)
        for name, place in (("zero", self.zero), ("block", self.block)):
            if place is not None:
                told[name] = " ".join(repr(float(each)) for each in place)
        return told

    def plant_options(self) -> dict[str, dict[str, Any]]:
        """Return the keywords of the simulated robot, cut, tracker and force sensor."""
        cell, pocket = self.cell, self.path.pocket
        robot = {"arm": cell.robot.arm, "tool": cell.robot.tool, "start": tuple(self.joints[0].tolist())}
        origin = self.path.origin(self.arm) if self.block is None else self.block
        length, width, thickness = pocket.workpiece
        cut: dict[str, Any] = {"tool": pocket.tool, "length": length, "width": width, "thickness": thickness}
        cut |= {"origin": tuple(origin.tolist()), **cell.plants.pocket_options}
        return {
            "robot": robot | cell.simulator.options | cell.plants.robot_options | {"run": self.number},
            "cut": cut | {"seed": BLOCKS * cut.get("seed", 1) + self.number},
            "tracker": {**cell.plants.tracker_options, "run": self.number},
            "sensor": {**cell.plants.force_sensor_options, "run_number": self.number},
        }


def first_trial(cell: CellConfig, task: str) -> Trial:
    """Return the first trial of a task: the path wanted itself, in the air.

    Parameters
    ----------
    cell : CellConfig
    task : str, of `TASKS`

    Raises
    ------
    ValueError : another task, or a path that the robot does not reach.
    """
    made = cell_for_task(cell, task)
    return in_the_air(made, pocket_path(made.pocket))


def in_the_air(cell: CellConfig, path: ToolPath) -> Trial:
    """Return the first trial of a path: sent as it is wanted, in the air.

    Parameters
    ----------
    cell : CellConfig
    path : ToolPath

    Raises
    ------
    ValueError : the robot does not reach it.
    """
    made = cell_of(cell, path)
    path.joints(tool_arm(made), path.wanted[::50])
    return Trial(made, path, 0, path.wanted, False)


def cell_for_task(cell: CellConfig, task: str, is_live: bool = False) -> CellConfig:
    """Return the cell with the pocket of a task, of `TASKS`, and the arm that mills it.

    Raises
    ------
    ValueError : another task; a live robot that is another arm.
    """
    if is_live:
        refuse_another_arm(cell, "pocket.arm", cell.pocket.arm)
    if task not in TASKS:
        raise ValueError(f"task is {task!r}, must be one of {', '.join(TASKS)}")
    arm = cell.pocket.arm or cell.robot.arm
    pocket = Pocket(**{**cell.pocket.model_dump(), **TASKS[task], "arm": arm})
    robot = cell.robot.model_copy(update={"arm": arm})
    return cell.model_copy(update={"robot": robot, "pocket": pocket})


def tool_arm(cell: CellConfig) -> Arm:
    """Return the cell's arm, to its tool point."""
    return arm_of(cell).with_tool(cell.robot.tool)


def cell_of(cell: CellConfig, path: ToolPath) -> CellConfig:
    """Return the cell with a box around the path, and what learning may move, as its limits.

    Parameters
    ----------
    cell : CellConfig
    path : ToolPath
    """
    where = path.origin(tool_arm(cell)) + path.wanted
    box = {
        "lowest": tuple((where.min(axis=0) - path.pocket.margin).tolist()),
        "highest": tuple((where.max(axis=0) + path.pocket.margin).tolist()),
    }
    limits = cell.limits.model_copy(update={**box, "correction": cell.learning.correction})
    return cell.model_copy(update={"limits": limits})
