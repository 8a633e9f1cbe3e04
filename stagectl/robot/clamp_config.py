"""The table `[clamping]` of the cell's file, and the procedure that it describes."""

from collections.abc import Sequence

import numpy as np

from rigkit.config import Section, setting
from stagectl.robot.arm import Arm
from stagectl.robot.clamp_procedure import ClampLimits, ClampProcedure

PerJoint = tuple[float, ...]


class Clamping(Section):
    """Joints identified in a clamp: pose, limits and motions; where there are six numbers, one a joint."""

    live: bool = setting(False, "", "the robot behind the wires of [robot]; else the one of [simulator]", role="plant")
    track: bool = setting(True, "", "live: record the poses of base, links and tool that [tracker] sees")
    pose: PerJoint = setting((20.0, 30.0, -30.0, 40.0, 50.0, 20.0), "deg", "where the tool is clamped")
    leave: PerJoint = setting((0.0, 0.0, 0.0, 0.0, 30.0, 0.0), "deg", "where the arm goes afterwards")
    softness: PerJoint = setting((0.85,) * 6, "1", "part of the position gain that soft servo takes away")
    speed: PerJoint = setting((20e-3,) * 6, "rad/s", "of references while clamped")
    approach: float = setting(0.1, "rad/s", "of the fastest joint on the way to the clamp and back", gt=0, le=1)
    torque: PerJoint = setting((200.0, 300.0, 160.0, 40.0, 36.0, 20.0), "N m", "beyond which the procedure aborts")
    turn: PerJoint = setting((100.0, 150.0, 80.0, 20.0, 18.0, 10.0), "N m", "where alternating motions turn")
    proof: PerJoint = setting((50.0, 75.0, 40.0, 10.0, 9.0, 5.0), "N m", "that a clamped joint must meet")
    quiet: PerJoint = setting((4.0, 6.0, 4.0, 1.0, 1.0, 0.6), "N m", "what counts as no torque")
    travel: PerJoint = setting((20e-3,) * 6, "rad", "by which a motor may move while clamped")
    reach: PerJoint = setting((0.3,) * 6, "rad", "by which a reference may move while clamped")
    search_step: PerJoint = setting((5e-3,) * 6, "rad", "first step of a reference in the zero-torque search")
    rounds: int = setting(60, "", "of that search over all joints, at most", ge=1, le=10_000)
    settle: float = setting(0.2, "s", "after a motion, before torque is looked at", gt=0, le=10)
    cycles: int = setting(5, "", "to and fro of every joint", ge=2, le=1_000)
    patience: float = setting(10.0, "s", "for soft servo and clamp to answer", gt=0, le=3_600, role="patience")
    compliance: float = setting(
        0.0, "m/N", "of what the clamp is fastened to, along each axis, where it is known; else 0", ge=0, le=1e-4
    )
    compliance_turn: float = setting(0.0, "rad/(N m)", "and about each axis", ge=0, le=1e-2)

    @property
    def environment(self) -> np.ndarray:
        """The clamp's compliance, shape (6, 6), m/N and rad/(N m)."""
        return np.diag([self.compliance] * 3 + [self.compliance_turn] * 3)


def clamp_procedure(clamping: Clamping, arm: Arm, joints: Sequence[int]) -> ClampProcedure:
    """Return the procedure for some joints.

    Parameters
    ----------
    clamping : Clamping
    arm : Arm
        With its tool: the last link goes as far as the clamp.
    joints : sequence of int
        From 0.

    Raises
    ------
    ValueError : limits that do not fit together or to the arm.
    """
    per_joint = ("softness", "speed", "torque", "turn", "proof", "quiet", "travel", "reach", "search_step")
    for name in (*per_joint, "pose", "leave"):
        if len(getattr(clamping, name)) != arm.joints:
            raise ValueError(
                f"clamping.{name} has {len(getattr(clamping, name))} numbers, must be {arm.joints}, one a joint"
            )
    limits = ClampLimits(
        **{name: np.array(getattr(clamping, name)) for name in per_joint},
        approach=clamping.approach,
        rounds=clamping.rounds,
        settle=clamping.settle,
        cycles=clamping.cycles,
        patience=clamping.patience,
    )
    return ClampProcedure(arm, np.radians(clamping.pose), np.radians(clamping.leave), tuple(joints), limits)
