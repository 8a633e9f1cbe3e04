"""The file of a clamping experiment: arm, poses, limits, and what stands at the other end."""

from typing import Any, Self

import numpy as np
from pydantic import Field, model_validator

from rigkit.config import Section, setting
from stagectl.robot.arm import Arm, irb140, read_arm
from stagectl.robot.clamp_procedure import ClampLimits, ClampProcedure

PerJoint = tuple[float, ...]


class Robot(Section):
    """The robot: its geometry, and the block that it is reached through."""

    arm: str = setting("irb140", "", "irb140, or a TOML file with an arm's geometry and limits", min_length=1)
    tool: float = setting(0.1, "m", "from flange to clamp, along the flange's axis", ge=0, le=2)
    rate: float = setting(250.0, "samples/s", "of references, angles and torques", ge=10, le=10_000)
    block: str = setting(
        "firmware_sim.clamped_robot:ClampedRobot",
        "",
        "package.module:Name of a block with the ports of `ClampSearch`, the other way round",
    )
    options: dict[str, Any] = Field(
        default_factory=dict, description="what that block is made with", json_schema_extra={"unit": ""}
    )


class Clamping(Section):
    """Poses and limits of the procedure; a number a joint."""

    pose: PerJoint = setting((20.0, 30.0, -30.0, 40.0, 50.0, 20.0), "deg", "where the tool is clamped")
    leave: PerJoint = setting((0.0, 0.0, 0.0, 0.0, 30.0, 0.0), "deg", "where the arm goes afterwards")
    softness: PerJoint = setting((0.85,) * 6, "1", "part of the position gain that soft servo takes away")
    speed: PerJoint = setting((20e-3,) * 6, "rad/s", "of references while clamped")
    approach: float = setting(0.2, "rad/s", "of the fastest joint on the way to the clamp and back", gt=0, le=1)
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
    patience: float = setting(10.0, "s", "for soft servo and clamp to answer", gt=0, le=3_600)


class JointsConfig(Section):
    """A whole file of a clamping experiment."""

    robot: Robot = Field(default_factory=Robot)
    clamping: Clamping = Field(default_factory=Clamping)

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        procedure(self, (0,))
        return self


def clamped_arm(config: JointsConfig) -> Arm:
    """Return the arm with its tool: the last link goes as far as the clamp."""
    name = config.robot.arm
    return (irb140() if name == "irb140" else read_arm(name)).with_tool(config.robot.tool)


def procedure(config: JointsConfig, joints: tuple[int, ...]) -> ClampProcedure:
    """Return the procedure for some joints, from 0.

    Raises
    ------
    ValueError : limits that do not fit together or to the arm.
    """
    clamping = config.clamping
    per_joint = ("softness", "speed", "torque", "turn", "proof", "quiet", "travel", "reach", "search_step")
    limits = ClampLimits(
        **{name: np.array(getattr(clamping, name)) for name in per_joint},
        approach=clamping.approach,
        rounds=clamping.rounds,
        settle=clamping.settle,
        cycles=clamping.cycles,
        patience=clamping.patience,
    )
    return ClampProcedure(clamped_arm(config), np.radians(clamping.pose), np.radians(clamping.leave), joints, limits)
