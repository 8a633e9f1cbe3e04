"""A run of force-controlled milling before its first sample: the pocket, where it lies, and who controls the feed."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from calibration.state_space.model import InnovationModel
from ctlblocks.recording import Recording
from stagectl.planning.problem import Pocket
from stagectl.robot.arm import Arm
from stagectl.robot.config import CellConfig
from stagectl.robot.kinematics import forward
from stagectl.robot.port import arm_of

RATE = 2_000.0
"""samples/s, of the graph: robot and cut."""
CONTROLS = {"force": "the force is controlled by the feed", "position": "a safe feed, the same all along a strip"}
"""Who controls the feed."""
ROOM = 15e-3
"""m of wood around the pocket."""


@dataclass(frozen=True, eq=False)
class FeedPlan:
    """What is milled, and how.

    Parameters
    ----------
    cell : CellConfig
        As `feed_plan` gives it.
    pocket : Pocket
    model : InnovationModel
        Of the robot's velocity.
    piece : int
        Number of the piece of wood, from 1: each has its own grain.
    feeds : mapping of type to float, m/s
        Of position control; none where the force is controlled.
    """

    cell: CellConfig
    pocket: Pocket
    model: InnovationModel
    piece: int = 1
    feeds: Mapping[str, float] | None = None

    @property
    def control(self) -> str:
        """One of `CONTROLS`."""
        return "force" if self.feeds is None else "position"

    @property
    def name(self) -> str:
        """What its recording is called."""
        return f"{self.control}-{self.piece}"

    @property
    def about(self) -> dict[str, str]:
        """What is to be known of it beside its recording: provenance of that."""
        feeds = {} if self.feeds is None else {"feeds": json.dumps(dict(self.feeds))}
        return {"control": self.control, "piece": str(self.piece), **feeds}

    @property
    def home(self) -> np.ndarray:
        """Joint angles at the beginning, shape (6,), rad."""
        return np.array(self.cell.segments.home)

    @cached_property
    def arm(self) -> Arm:
        """The robot, to its flange."""
        return arm_of(self.cell)

    @cached_property
    def top(self) -> np.ndarray:
        """The middle of the pocket on the workpiece's top, in the base, shape (3,), m."""
        place: np.ndarray = forward(self.arm.with_tool(self.cell.robot.tool), self.home)[:3, 3]
        top: np.ndarray = place - np.array([0.0, 0.0, self.cell.segments.lift])
        return top

    @property
    def corner(self) -> np.ndarray:
        """The pocket's north-west corner at the depth of the cut, in the base, shape (3,), m: east is x, north y."""
        segments, half = self.cell.segments, 0.5 * self.cell.segments.cell
        corner: np.ndarray = self.top + np.array([-half * self.pocket.cols, half * self.pocket.rows, -segments.depth])
        return corner

    def plant_options(self) -> dict[str, dict[str, Any]]:
        """Return the keywords of the simulated robot, cut and force sensor."""
        cell, task, given = self.cell, self.cell.segments, self.cell.feed_plants.cut_options
        robot = {"arm": cell.robot.arm, "tool": cell.robot.tool, "start": tuple(self.home.tolist())}
        cut = {
            "origin": tuple(self.top.tolist()),
            "tool": self.pocket.G * task.cell,
            "length": self.pocket.cols * task.cell + 2 * ROOM,
            "width": self.pocket.rows * task.cell + 2 * ROOM,
        }
        drawn = {"seed": given.get("seed", 1) + self.piece - 1}
        return {
            "robot": cell.simulator.options | robot | cell.plants.robot_options,
            "cut": cut | given | drawn,
            "sensor": {**cell.plants.force_sensor_options},
        }


def recorded_plan(
    cell: CellConfig,
    pocket: Pocket,
    model: InnovationModel,
    record: Recording,
    name: str,
    feeds: Mapping[str, float] | None = None,
) -> FeedPlan:
    """Return the plan by which a recording was made.

    Parameters
    ----------
    cell : CellConfig
    pocket : Pocket
    model : InnovationModel
    record : Recording
    name : str
        What it is called.
    feeds : mapping of type to float, m/s, optional
        Where the recording does not say them.
    """
    told = record.provenance.get("feeds")
    control, _, piece = name.rpartition("-")
    known = json.loads(told) if told else feeds
    return feed_plan(cell, pocket, model, int(piece), known if control == "position" else None)


def feed_plan(
    cell: CellConfig,
    pocket: Pocket,
    model: InnovationModel,
    piece: int = 1,
    feeds: Mapping[str, float] | None = None,
) -> FeedPlan:
    """Put a run together.

    Parameters
    ----------
    cell : CellConfig
    pocket : Pocket
    model : InnovationModel
    piece : int
    feeds : mapping of type to float, m/s, optional

    Raises
    ------
    ValueError : the robot does not stand at home within its limits, or a type has no feed.
    """
    made = FeedPlan(cell, pocket, model, piece, feeds)
    made.arm.refuse_outside(made.home[None])
    missing = [name for name in pocket.types if feeds is not None and name not in feeds]
    if missing:
        raise ValueError(f"there is no feed for {', '.join(missing)}, must be one for each type of the pocket")
    segments = cell.segments
    half = 0.5 * segments.cell * np.array([pocket.cols, pocket.rows]) + segments.margin
    low = made.top - np.array([*half, segments.depth + segments.margin])
    high = made.top + np.array([*half, segments.lift + segments.margin])
    box = {"lowest": tuple(low.tolist()), "highest": tuple(high.tolist())}
    limits = cell.limits.model_copy(update=box)
    return FeedPlan(cell.model_copy(update={"limits": limits}), pocket, model, piece, feeds)
