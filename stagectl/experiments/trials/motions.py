"""All that moves in trials on a robot, in words."""

import numpy as np

from stagectl.experiments.trials.tool_path import RATE
from stagectl.experiments.trials.trial import Trial, tool_arm
from stagectl.robot.config import CellConfig


def steps(cell: CellConfig, first: Trial, trials: int) -> list[str]:
    """Return in words all that moves in live trials, in order.

    Parameters
    ----------
    cell : CellConfig
    first : Trial
    trials : int
        In material.
    """
    path = first.path
    lowest, highest = (1e3 * each(path.wanted, axis=0) for each in (np.min, np.max))
    changes = "the robot's program changes the blocks" if cell.robot.changer else "a person changes the blocks"
    before, after = ways(cell, first)
    return [
        before,
        f"{cell.learning.free + 1} air cuts, x {lowest[0]:.0f} to {highest[0]:.0f}, y {lowest[1]:.0f} to "
        f"{highest[1]:.0f}, z {lowest[2]:.0f} to {highest[2]:.0f} mm in the workpiece, and up to "
        f"{1e3 * cell.learning.correction:g} mm beside that: {path.samples / RATE:.1f} s each, no block under the tool",
        f"{trials} trials in material, {1e3 * path.pocket.depth:g} mm deep: {path.samples / RATE:.1f} s each, a fresh "
        f"block each; {changes}",
        after,
    ]


def ways(cell: CellConfig, first: Trial) -> tuple[str, str]:
    """Return in words how the tool comes to a live trial, and away from it.

    Parameters
    ----------
    cell : CellConfig
    first : Trial
    """
    robot, path = cell.robot, first.path
    origin = path.origin(tool_arm(cell))
    up = f"straight up to {1e3 * robot.height:g} mm over the surface"
    return (
        f"before each trial: {up}, z = {1e3 * origin[2]:.1f} mm in the base, across to x = {1e3 * origin[0]:.1f}, y = "
        f"{1e3 * origin[1]:.1f} mm, down to {1e3 * path.pocket.clearance:g} mm over it; at most "
        f"{1e3 * robot.travel:g} mm/s",
        f"after each trial: {up}",
    )
