"""A path of a trial, and its joint angles; and which paths are refused before anything moves."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stagectl.robot.arm import Arm
from stagectl.robot.kinematics import forward
from stagectl.robot.pocket_config import Pocket
from stagectl.robot.tool_path import joints_at

RATE = 250.0
"""samples/s, of a trial."""
BEFORE, AFTER = 0.05, 0.3
"""s around a path's motion that are no rest."""


@dataclass(frozen=True, eq=False)
class ToolPath:
    """Where the tool's tip is wanted, sample by sample: in the workpiece, from the middle of its surface, z upwards.

    Parameters
    ----------
    pocket : Pocket
    wanted : array, shape (samples, 3), m
        r.
    """

    pocket: Pocket
    wanted: np.ndarray

    @property
    def samples(self) -> int:
        """How long a trial is."""
        return len(self.wanted)

    @property
    def seconds(self) -> float:
        """The same, s."""
        return len(self.wanted) / RATE

    @cached_property
    def milled(self) -> np.ndarray:
        """Which samples are measured, shape (samples,): the tool in the material, from its descent to its lift."""
        inside = self.wanted[:, 2] < 0.0
        found = np.zeros(self.samples, bool)
        if inside.any():
            found[int(np.argmax(inside)) : len(inside) - int(np.argmax(inside[::-1]))] = True
        return found

    @cached_property
    def moves(self) -> tuple[float, float]:
        """When it begins to move, and rests again after the robot has caught up, s."""
        moving = np.flatnonzero((np.diff(self.wanted, axis=0) != 0).any(axis=1))
        return float(moving[0]) / RATE - BEFORE, float(moving[-1]) / RATE + AFTER

    def raised(self) -> np.ndarray:
        """Return it with the tool at its clearance at least, shape (samples, 3), m."""
        lifted = self.wanted.copy()
        np.maximum(lifted[:, 2], self.pocket.clearance, out=lifted[:, 2])
        return lifted

    def joints(self, arm: Arm, path: np.ndarray) -> np.ndarray:
        """Return the joint angles that take the tool along a path in the workpiece, shape (N, 6), rad.

        Parameters
        ----------
        arm : Arm
            With its tool.
        path : array, shape (N, 3), m

        Raises
        ------
        ValueError : the arm does not reach it within its limits.
        """
        return joints_at(arm, np.array(self.pocket.home), self.origin(arm) + path)

    def in_workpiece(self, arm: Arm, joint_angle: np.ndarray) -> np.ndarray:
        """Return where motors' angles, shape (N, 6), rad, have the tool in the workpiece: y_r, shape (N, 3), m."""
        return np.asarray(forward(arm, joint_angle)[:, :3, 3] - self.origin(arm))

    def origin(self, arm: Arm) -> np.ndarray:
        """Return the workpiece's origin in the base, shape (3,), m."""
        return np.asarray(forward(arm, np.array(self.pocket.home))[:3, 3])


def refuse_outside(pocket: Pocket, wanted: np.ndarray, path: np.ndarray, stray: float) -> None:
    """Refuse a path that takes the tool out of the block, too near its sides, or far from where it is wanted.

    Parameters
    ----------
    pocket : Pocket
    wanted, path : arrays, shape (N, 3), m
        Where the tip is to be, and where it is predicted to be.
    stray : float, m

    Raises
    ------
    ValueError : it does; with where, by how much, and what is allowed.
    """
    reach = [0.5 * side - pocket.wall - 0.5 * pocket.tool for side in pocket.workpiece[:2]]
    inside = path[:, 2] < 0.0
    for axis, most in enumerate(reach):
        far = np.abs(path[:, axis]) * inside
        if not far.max() <= most:
            at = int(np.argmax(far))
            raise ValueError(
                f"the path leaves the workpiece: at {at / RATE:.3g} s the tool is predicted at "
                f"{'xy'[axis]} = {1e3 * path[at, axis]:.3f} mm, must stay within {1e3 * most:.3f} mm"
            )
    floor = pocket.wall - pocket.workpiece[2]
    if not path[:, 2].min() >= floor:
        raise ValueError(
            f"the path leaves the workpiece: the tool is predicted at z = {1e3 * path[:, 2].min():.3f} mm, must stay "
            f"above {1e3 * floor:.3f} mm"
        )
    off = np.linalg.norm(path - wanted, axis=1)
    if not off.max() <= stray:
        at = int(np.argmax(off))
        raise ValueError(
            f"at {at / RATE:.3g} s the tool is predicted {1e3 * off[at]:.3f} mm from where it is wanted, must be <= "
            f"{1e3 * stray:.3f} mm (learning.stray)"
        )


def refuse_large(wanted: np.ndarray, sent: np.ndarray, most: float) -> None:
    """Refuse a path that is further from the one wanted than corrections may move the tool, by ValueError.

    Parameters
    ----------
    wanted, sent : arrays, shape (N, 3), m
    most : float, m
    """
    far = np.linalg.norm(sent - wanted, axis=1)
    if not far.max() <= most:
        at = int(np.argmax(far))
        raise ValueError(
            f"at {at / RATE:.3g} s the correction moves the tool by {1e3 * far[at]:.3f} mm, must be <= "
            f"{1e3 * most:g} mm (learning.correction)"
        )
