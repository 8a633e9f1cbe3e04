"""A run of the cell before its first sample: setup, files, path, stage's loops, and the controllers of chapter 2."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from rigkit import config as rig_file
from stagectl.config import StageConfig
from stagectl.devices.signals import AXES, QUICK, SLOW
from stagectl.experiments.toroid.nominal_stage import nominal_model
from stagectl.experiments.toroid.toroid_path import ToroidPath
from stagectl.models.model_file import read_model
from stagectl.robot.arm import Arm
from stagectl.robot.config import CellConfig
from stagectl.robot.kinematics import forward
from stagectl.robot.midranging.tuning import Pi, lambda_tuned
from stagectl.robot.midranging.valve_position import ValvePositionAxis
from stagectl.robot.port import arm_of
from stagectl.stage.design import design
from stagectl.stage.state_feedback import StateFeedback
from stagectl.stage.weights import chosen_weights

SETUPS = {
    "A": "robot alone",
    "B": "robot and tracker",
    "C": "robot, tracker, stage and mid-ranging",
    "C-fixed": "robot, tracker and stage, without mid-ranging",
}
"""What each setup is [Sörnmo 2015, sec. 2.6]; the last is not in Table 2.3."""
ALL = "all"
"""One after the other."""
TOUCH_OFF = 0.6, 0.1
"""s from the beginning, and before the end of the lead: in between everything stands still and is averaged."""
PUSHED = ("outer.push=0.1",)
"""Of a stage without a file of its own."""
LOOKS = 100
"""Points of the path that are looked at before a run: the robot reaches them."""
RATE = 10_000.0
"""samples/s, of the simulated graph and of the stage."""


@dataclass(frozen=True)
class Pace:
    """How often what is in a graph goes on.

    Parameters
    ----------
    rate : float, samples/s
        Of the graph.
    quick, slow, stage : int, ticks
        From one sample to the next of tracker, robot's port, and stage.
    """

    rate: float
    quick: int
    slow: int
    stage: int

    @property
    def every(self) -> dict[str, int]:
        """Ticks between two samples, by recording."""
        return {"cell": self.slow, "surface": self.quick, "tracker": self.quick, "stage": self.stage}


SIMULATED = Pace(RATE, QUICK, SLOW, 1)
WIRED = Pace(RATE / QUICK, 1, SLOW // QUICK, SLOW // QUICK)
"""The stage's loops are in its own processor: what it is asked for and where it is goes over its wire."""


@dataclass(frozen=True)
class Plan:
    """What is run.

    Parameters
    ----------
    setup : str, of `SETUPS`
    cell : CellConfig
        As `cell_of` gives it.
    stage : StageConfig
    loops : tuple of StateFeedback
        The stage's outer loops, one an axis; none of setups without stage, nor of one behind its wire.
    is_live : bool
        Whether robot, tracker and stage are behind their wires.
    """

    setup: str
    cell: CellConfig
    stage: StageConfig
    loops: tuple[StateFeedback, ...]
    is_live: bool = False

    @property
    def pace(self) -> Pace:
        """How often robot, tracker and stage go on."""
        return WIRED if self.is_live else SIMULATED

    @property
    def has_stage(self) -> bool:
        """Whether the tool is on the stage."""
        return self.setup.startswith("C")

    @property
    def has_mid_ranging(self) -> bool:
        """Whether the robot takes over what the stage does."""
        return self.setup == "C"

    @cached_property
    def path(self) -> ToroidPath:
        """The circle."""
        return ToroidPath(self.cell.toroid)

    @cached_property
    def arm(self) -> Arm:
        """The robot, to its tool point."""
        return arm_of(self.cell).with_tool(self.cell.robot.tool)

    @property
    def by_laser(self) -> tuple[bool, bool, bool]:
        """Which axes have a laser; none is on the stage's wire."""
        return (self.has_stage and self.cell.feedback.laser and not self.is_live, False, False)

    @property
    def corners(self) -> tuple[float, ...]:
        """Of the low-passes for the tracker, Hz, an axis each."""
        feedback = self.cell.feedback
        return tuple(
            feedback.laser_corner if laser else each for each, laser in zip(feedback.corner, self.by_laser, strict=True)
        )

    @property
    def robot_share(self) -> float:
        """By what the robot moves the workpiece for a metre that the tool is to be moved in it."""
        return -1.0 if self.setup in ("B", "C") else 0.0

    @property
    def turning(self) -> float:
        """In which the robot turns the workpiece back, s; 0 where it never does."""
        return self.cell.feedback.orientation if self.robot_share else 0.0

    def controllers(self) -> list[ValvePositionAxis]:
        """Return the PI controllers of every axis; of setup B the first of each is the robot's."""
        feedback, idle = self.cell.feedback, Pi(0.0, 0.0)
        if self.setup == "A":
            return [ValvePositionAxis(idle, idle)] * 3
        if not self.has_stage:
            alone = lambda_tuned(feedback.robot_model, feedback.robot)
            return [ValvePositionAxis(alone, idle)] * 3
        low, high = self.stage.limits.travel
        return [
            ValvePositionAxis(
                fast=lambda_tuned(feedback.stage_model, wanted),
                slow=lambda_tuned(feedback.robot_model, feedback.takeover),
                tracking=wanted,
                limit=(high - low) / 2,
            )
            for wanted in feedback.stage
        ]

    def plant_options(self) -> dict[str, dict[str, Any]]:
        """Return the keywords of the simulated robot, cut and tracker."""
        cell, toroid = self.cell, self.cell.toroid
        start = self.path.joints(self.arm, np.zeros(1))[0]
        robot = {
            "arm": toroid.arm,
            "tool": cell.robot.tool,
            "payload": toroid.workpiece,
            "start": tuple(start.tolist()),
        }
        cut = {"radius": toroid.radius, "feed": toroid.feed, "start": toroid.lead, "seconds": self.path.seconds}
        return {
            "robot": cell.simulator.options | robot | cell.plants.robot_options,
            "cut": cut | cell.plants.cut_options,
            "tracker": {**cell.plants.tracker_options},
        }


def plan(
    setup: str, cell: CellConfig, stage: StageConfig, loops: Sequence[StateFeedback] = (), is_live: bool = False
) -> Plan:
    """Put a run together.

    Parameters
    ----------
    setup : str
    cell : CellConfig
    stage : StageConfig
    loops : sequence of StateFeedback
        `loops_of(stage, ...)`; setups without stage need none, nor does a stage behind its wire.
    is_live : bool

    Raises
    ------
    ValueError : another setup, or a path that the robot does not reach.
    """
    if setup not in SETUPS:
        raise ValueError(f"setup is {setup!r}, must be one of {', '.join(SETUPS)}")
    made = Plan(setup, cell_of(cell), stage, tuple(loops) if setup.startswith("C") else (), is_live)
    made.path.joints(made.arm, np.linspace(0.0, made.path.end, LOOKS))
    return made


def stage_of(file: Path | None) -> StageConfig:
    """Read the stage's own file; where there is none, all is as by default, but for loops that damp what a cut shakes.

    The force of a cut answers the tool's vibrations, those of the stage's modes too.
    """
    return rig_file.load(file, StageConfig, () if file is not None else PUSHED)


def loops_of(stage: StageConfig, models: Sequence[Path] = ()) -> list[StateFeedback]:
    """Read the models and design the stage's outer loops.

    Parameters
    ----------
    stage : StageConfig
    models : sequence of Path
        Model files of the stage, one an axis, in the order of `stage.axes`; none for the nominal ones.

    Raises
    ------
    ValueError : another stage than one of three axes x, y, z at 10 kHz, or models that do not fit.
    """
    axes, rate = stage.stage.axes, stage.stage.rate
    if axes != AXES or rate != RATE:
        raise ValueError(f"the stage has axes {', '.join(axes)} at {rate:g} samples/s, must be x, y, z at {RATE:g}")
    refuse_count(models)
    known = [read_model(file, rate=rate) for file in models] or [nominal_model(axis, rate) for axis in axes]
    return [
        design(each, stage.outer, axis, chosen_weights(stage.weights, axis)).loop for axis, each in enumerate(known)
    ]


def refuse_count(models: Sequence[Path]) -> None:
    """Refuse, by ValueError, another number of a stage's models than one an axis, or none."""
    if len(models) not in (0, len(AXES)):
        raise ValueError(f"there are {len(models)} model files, must be one for each of the axes x, y, z, or none")


def cell_of(cell: CellConfig) -> CellConfig:
    """Return the cell with the toroid's arm at the port, and a box around the path as its limits."""
    robot = cell.robot.model_copy(update={"arm": cell.toroid.arm})
    made = cell.model_copy(update={"robot": robot})
    arm = arm_of(made).with_tool(robot.tool)
    middle = forward(arm, np.array(cell.toroid.home))[:3, 3]
    room = np.array([0.0, cell.toroid.radius, cell.toroid.radius]) + cell.toroid.margin
    box = {"lowest": tuple((middle - room).tolist()), "highest": tuple((middle + room).tolist())}
    return made.model_copy(update={"limits": cell.limits.model_copy(update=box)})
