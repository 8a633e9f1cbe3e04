"""The last thing before the wire to the robot: limits that latch, and the hold that follows."""

import numpy as np

from stagectl.robot.arm import Arm
from stagectl.robot.config import RobotLimits
from stagectl.robot.guard_kernel import (
    BOX,
    CORRECTION,
    FINE,
    NOT_FINITE,
    POSITION,
    ROTATION,
    SPEED,
    TOOL_SPEED,
    check_joints,
    check_pose,
)
from stagectl.wire.robot import RATE

_ROOM = 1 + 1e-9
"""A limit is met by what is just on it, after rounding."""


class CommandGuard:
    """Lets references through while all is within the limits; after that it brings them to rest and holds them.

    Parameters
    ----------
    arm : Arm
    limits : RobotLimits
    mode : "joints" or "pose"
        References are joint angles, shape (6,), rad, or poses, shape (7,), m and unit quaternion w x y z.
    tool : float, m, from the flange along its axis to the point whose way is limited, for joint angles
    """

    def __init__(self, arm: Arm, limits: RobotLimits, mode: str, tool: float = 0.0) -> None:
        self.limits, self.mode = limits, mode
        self.width = arm.joints if mode == "joints" else 7
        self.is_holding = True
        self.sent = np.full(self.width, np.nan)
        self._step, self._decay = np.zeros(self.width), 1.0
        self._chain = np.stack([arm.offset, arm.d, arm.a, arm.alpha], axis=1)
        self._turn = limits.turn_speed / RATE * _ROOM
        self._work = np.zeros((3, 3, 4))
        self._table = np.zeros((5, 6))
        self._table[0] = arm.low + limits.margin
        self._table[1] = arm.high - limits.margin
        self._table[2] = limits.speed * arm.speed / RATE * _ROOM
        self._table[3, :4] = limits.correction, limits.rotation, limits.tool_speed / RATE * _ROOM, tool
        self._table[4] = *limits.lowest, *limits.highest
        self._check(np.zeros(self.width), np.zeros(self.width))  # compiles: the first cycle must not wait for it

    def place(self, reference: np.ndarray) -> None:
        """Begin at rest where the robot is, shape (6,), rad, or (7,), m and 1."""
        self.sent[:] = reference
        self._step[:] = 0.0

    def release(self) -> None:
        """Let references through again."""
        self.is_holding = False

    def hold(self) -> None:
        """Let nothing through any more: what is sent comes to rest within `limits.stop`."""
        if not self.is_holding:
            self.is_holding = True
            self._decay = 1.0 - 1.0 / max(self.limits.stop * RATE / 4, 1.0)

    def take(self, nominal: np.ndarray, wanted: np.ndarray) -> str:
        """Send `wanted`, which is `nominal` and a correction, both shape (6,) or (7,); or hold, and return why.

        Parameters
        ----------
        nominal, wanted : arrays, shape (6,), rad, or shape (7,), m and 1
        """
        found = self._check(nominal, wanted)
        if found[0] != FINE:
            self.hold()
            return self._words(*found)
        np.subtract(wanted, self.sent, out=self._step)
        self.sent[:] = wanted
        return ""

    def rest(self) -> None:
        """Go on holding for a cycle: slower each time, then not at all; a limit of position is never passed."""
        self._step *= self._decay
        self._step[np.abs(self._step) < 1e-9] = 0.0
        self.sent += self._step
        if self.mode == "joints":
            np.clip(self.sent, self._table[0], self._table[1], out=self.sent)
        else:
            np.clip(self.sent[:3], self._table[4, :3], self._table[4, 3:], out=self.sent[:3])
            self.sent[3:] /= np.linalg.norm(self.sent[3:])

    def _check(self, nominal: np.ndarray, wanted: np.ndarray) -> tuple[int, int, float, float]:
        if self.mode == "joints":
            return check_joints(nominal, wanted, self.sent, self._table, self._chain, self._work)
        return check_pose(nominal, wanted, self.sent, self._table, self._turn, self._work)

    def _words(self, fault: int, at: int, value: float, limit: float) -> str:
        deg, mm = np.degrees(1.0), 1e3
        axis = "xyz"[at] if fault == BOX else ""
        return {
            NOT_FINITE: f"the reference of joint {at + 1} is {value}, must be a number",
            POSITION: f"joint {at + 1} is asked to {value * deg:.4g} deg, must stay within {limit * deg:.4g} deg",
            SPEED: f"{f'joint {at + 1}' if self.mode == 'joints' else 'the tool'} is asked to turn by "
            f"{value * RATE * deg:.4g} deg/s, must be <= {limit * RATE * deg:.4g} deg/s",
            CORRECTION: f"the correction moves the tool by {value * mm:.4g} mm, must be <= {limit * mm:.4g} mm",
            ROTATION: f"the correction turns the tool by {value * mm:.4g} mrad, must be <= {limit * mm:.4g} mrad",
            TOOL_SPEED: f"the tool is asked to move at {value * RATE:.4g} m/s, must be <= {limit * RATE:.4g} m/s",
            BOX: f"the tool is asked to {axis} = {value:.4g} m, must stay within {limit:.4g} m",
        }[fault]
