"""The path of the toroid: where the tool is wanted in the workpiece, and the joint angles that take it there."""

from dataclasses import dataclass

import numpy as np

from stagectl.robot.arm import Arm
from stagectl.robot.kinematics import forward
from stagectl.robot.tool_path import joints_at, ramped
from stagectl.robot.toroid_config import Toroid

TAIL = 0.5
"""s, at rest after the circle."""


@dataclass(frozen=True)
class ToroidPath:
    """A circle in y and z around the toroid's centre, counterclockwise from the top; the tool's axis is x.

    Parameters
    ----------
    toroid : Toroid
    """

    toroid: Toroid

    @property
    def length(self) -> float:
        """What is milled, m."""
        return 2.0 * np.pi * self.toroid.radius * self.toroid.turn

    @property
    def end(self) -> float:
        """When the tool stands still again, s."""
        toroid = self.toroid
        ramp = min(toroid.ramp, self.length / toroid.feed)  # a part shorter than its ramps has slower ones
        return toroid.lead + self.length / toroid.feed + ramp

    @property
    def seconds(self) -> float:
        """How long a run is, s, in whole hundredths."""
        return float(np.ceil(100.0 * (self.end + TAIL)) / 100.0)

    def way(self, time: np.ndarray) -> np.ndarray:
        """Return how far along the circle the tool is, m, at times, shape (n,), s: same shape."""
        toroid, seconds = self.toroid, self.length / self.toroid.feed
        return np.asarray(toroid.feed * ramped(np.asarray(time) - toroid.lead, seconds, min(toroid.ramp, seconds)))

    def wanted(self, time: np.ndarray) -> np.ndarray:
        """Return where the tool is to be in the workpiece, shape (n, 3), m, at times, shape (n,), s."""
        angle = 0.5 * np.pi + self.way(time) / self.toroid.radius
        return self.toroid.radius * np.column_stack([np.zeros(len(angle)), np.cos(angle), np.sin(angle)])

    def joints(self, arm: Arm, time: np.ndarray) -> np.ndarray:
        """Return the joint angles that move the workpiece so, shape (n, 6), rad.

        Parameters
        ----------
        arm : Arm
            With its tool: its flange is the toroid's centre.
        time : array, shape (n,), s

        Raises
        ------
        ValueError : the arm does not reach it within its limits.
        """
        home = np.array(self.toroid.home)
        return joints_at(arm, home, forward(arm, home)[:3, 3] - self.wanted(time))
