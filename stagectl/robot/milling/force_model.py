"""From angles and torques of the motors to forces on the tool: arm, gravity and friction; a record, or a Block."""

from dataclasses import dataclass

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.robot.arm import Arm
from stagectl.robot.learning_config import Margin
from stagectl.robot.milling import record_kernel as kernel
from stagectl.robot.milling.force_estimate import TIE_BREAKS, ForceEstimates
from stagectl.robot.milling.force_margin import FADE, packed_margin
from stagectl.robot.milling.friction_range import FrictionRange, speed_pole
from stagectl.robot.milling.gravity import STANDARD_GRAVITY, Gravity, packed_chain


@dataclass(frozen=True, eq=False)
class ForceModel:
    """An arm whose motors' torques are known well enough to tell the force on its tool.

    Parameters
    ----------
    arm : Arm
        Of six joints, with its tool: the force is at the flange's origin.
    gravity : Gravity
    friction : FrictionRange
    inertia : array, shape (6,), kg m^2
        Torque over acceleration of each joint, its motor's and what it carries, in the middle of the workspace.
    tie_break : "centre" or "minimum-norm"
        As for `estimate_force`.
    margin : Margin
        What bounds hold beside friction; all zeros: those of the forces that are as likely.

    Raises
    ------
    ValueError : another number of joints, an inertia that is none, a tie-break there is not.
    """

    arm: Arm
    gravity: Gravity
    friction: FrictionRange
    inertia: np.ndarray
    tie_break: str = "centre"
    margin: Margin = Margin()

    def __post_init__(self) -> None:
        """Refuse what the kernel cannot do."""
        packed_chain(self.arm)
        packed_margin(self.margin, self.friction.covariance, self.inertia)
        if self.tie_break not in TIE_BREAKS:
            raise ValueError(f"tie_break is {self.tie_break!r}, must be one of {', '.join(TIE_BREAKS)}")

    def estimate(self, joint_angle: np.ndarray, torque: np.ndarray, rate: float) -> ForceEstimates:
        """Estimate the force in every sample of a record; the Block gives the same numbers.

        Parameters
        ----------
        joint_angle : array, shape (samples, 6), rad
            Of the motors, seen from the joints' side; NaN in a gap.
        torque : array, shape (samples, 6), N m
        rate : float, samples/s

        Returns
        -------
        ForceEstimates, of three parts
            Nothing is determined in a gap, and where a joint is faster than friction is known.
        """
        seen = tuple(np.ascontiguousarray(each, float) for each in (joint_angle, torque))
        force, low, high = np.empty((3, len(torque), 3))
        unique, objective = np.empty((2, len(torque), 1))
        told = force, low, high, unique, objective
        kernel.estimate_record(seen, self.packed(rate), TIE_BREAKS[self.tie_break], room(), told)
        return ForceEstimates(force, low, high, unique[:, 0] > 0.5, objective[:, 0])

    def packed(self, rate: float) -> tuple[np.ndarray, ...]:
        """Return the model as the kernel reads it."""
        friction = self.friction
        numbers = np.array([speed_pole(friction.smoothing, rate), rate, STANDARD_GRAVITY, np.exp(-1.0 / (FADE * rate))])
        margin = packed_margin(self.margin, friction.covariance, self.inertia)
        moments = np.ascontiguousarray(self.gravity.moments, float)
        chain = packed_chain(self.arm)
        return chain, moments, friction.speed, friction.bounds, friction.covariance, margin, numbers


def room() -> tuple[np.ndarray, ...]:
    """Return the kernel's memory and room, at the beginning of a record."""
    memory = np.zeros((kernel.MEMORY, 6))
    memory[kernel.ANGLE] = np.nan
    return memory, np.zeros((7, 3, 4)), np.zeros((kernel.ROWS, 6))


class ForceEstimate(Block):
    """Tell the force on the tool from the motors' torques, 250 times a second.

    Ports: `motor_angle` (rad, 6) and `torque` (N m, 6), seen from the joints' side, in; `force` (N, 3) on the tool in
    base axes, `lower` and `upper` (N, 3), its bounds, and `unique` (1 where one force only is as likely) out.  Where
    nothing is determined - a gap, a joint faster than friction is known, a singular arm - the force is NaN between
    infinite bounds.

    Parameters
    ----------
    model : ForceModel

    Source
    ------
    Sornmo 2015, eqs. (5.2)-(5.6); `estimate_force` says where it departs.
    """

    inputs = (Port("motor_angle", "rad", 6), Port("torque", "N m", 6))
    outputs = (Port("force", "N", 3), Port("lower", "N", 3), Port("upper", "N", 3), Port("unique"))

    def __init__(self, model: ForceModel) -> None:
        self.model = model

    def prepare(self, rate: float, frames: int) -> None:
        """Begin with an arm at rest."""
        self._model, self._which, self._room = self.model.packed(rate), TIE_BREAKS[self.model.tie_break], room()
        self._objective = np.empty((frames, 1))

    def process(
        self,
        motor_angle: np.ndarray,
        torque: np.ndarray,
        force: np.ndarray,
        lower: np.ndarray,
        upper: np.ndarray,
        unique: np.ndarray,
    ) -> None:
        """Fill one frame."""
        told = force, lower, upper, unique, self._objective
        kernel.estimate_record((motor_angle, torque), self._model, self._which, self._room, told)
