"""The path of the toroid: where the tool is wanted in the workpiece, and the joint angles that take it there."""

from dataclasses import dataclass

import numpy as np

from stagectl.robot.arm import Arm
from stagectl.robot.kinematics import forward, jacobian
from stagectl.robot.toroid_config import Toroid

ROUNDS = 6
"""Of Newton's method; from the middle of the circle three leave nothing to see."""
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
        toroid = self.toroid
        ramp = min(toroid.ramp, self.length / toroid.feed)
        since = np.clip(np.asarray(time) - toroid.lead, 0.0, self.end - toroid.lead)
        left = self.end - toroid.lead - since
        way = since - 0.5 * ramp
        begun, ending = since < ramp, left < ramp
        way[begun] = _eased(since[begun], ramp)
        way[ending] = self.length / toroid.feed - _eased(left[ending], ramp)
        return np.asarray(toroid.feed * way)

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
        middle, wanted = forward(arm, home), self.wanted(time)
        angle = np.tile(home, (len(wanted), 1))
        for _ in range(ROUNDS):
            now = forward(arm, angle)
            gap = np.concatenate(
                [middle[:3, 3] - wanted - now[:, :3, 3], _turn(now[:, :3, :3], middle[:3, :3])], axis=1
            )
            angle += np.linalg.solve(jacobian(arm, angle), gap[..., None])[..., 0]
        arm.refuse_outside(angle)
        return angle


def _eased(time: np.ndarray, ramp: float) -> np.ndarray:
    """Return the way, s at full feed, after so long (s) of a raised-cosine ramp of the feed: same shape."""
    return np.asarray(0.5 * (time - ramp / np.pi * np.sin(np.pi * time / ramp)))


def _turn(now: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Return the small rotation from orientations (n, 3, 3) to another (3, 3): shape (n, 3), rad."""
    return np.asarray(0.5 * np.cross(now, wanted[None], axisa=1, axisb=1, axisc=1).sum(axis=2))
