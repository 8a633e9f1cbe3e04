"""Where to clamp: for each joint the poses that will show most of its stiffness, as rows and figures."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from calibration.joint_clamping.lever_arm import Advice, advise, candidate_poses
from stagectl.robot.arm import Arm
from stagectl.robot.config import CellConfig
from stagectl.robot.kinematics import forward

HEAD = ("joint", "shown of its stiffness, %", "lever arm, m", "pose, deg")
CANDIDATES, SEED, SHOWN = 400, 1, 3
_WIND_UP = 1e-3
"""rad at the torque limit: a rough guess of a joint's own compliance."""
_ACROSS = 0.1
"""Of it, a guess of what its bearing tilts."""
_PLATE = np.diag([2e-8] * 3 + [2e-7] * 3)
"""m/N and rad/(N m): a bolted steel plate, where the clamp's compliance is not known."""


def advice(cell: CellConfig, arm: Arm, joints: Sequence[int]) -> list[Advice]:
    """Return the best clamping poses for each joint, `SHOWN` each, within the arm's limits and the tool's box.

    Compliances are guessed from the torque limits; only their ranking counts.

    Parameters
    ----------
    cell : CellConfig
    arm : Arm
        With its tool.
    joints : sequence of int
        From 0.

    Raises
    ------
    ValueError : no pose lies within the limits.
    """
    poses, limits = candidate_poses(arm, CANDIDATES, SEED, 0.0), cell.limits
    tool = forward(arm, poses)[:, :3, 3]
    inside = ((tool >= limits.lowest) & (tool <= limits.highest)).all(axis=1)
    inside &= ((poses >= arm.low + limits.margin) & (poses <= arm.high - limits.margin)).all(axis=1)
    own = _WIND_UP / np.array(cell.clamping.torque)
    environment = cell.clamping.environment if cell.clamping.compliance else _PLATE
    found = [
        advise(arm, joint, poses[inside], own, _ACROSS * own[:, None].repeat(2, 1), environment) for joint in joints
    ]
    if not all(found):
        raise ValueError(
            f"no clamping pose lies within limits.lowest {limits.lowest} and limits.highest {limits.highest}"
        )
    return [each for ranked in found for each in ranked[:SHOWN]]


def rows(found: Sequence[Advice]) -> list[tuple[str, ...]]:
    """Return a row a pose."""
    return [
        (
            str(each.joint + 1),
            f"{100 * each.measured_share:.0f}",
            f"{each.lever_arm:.2f}",
            ",".join(f"{angle:.0f}" for angle in np.degrees(each.pose)),
        )
        for each in found
    ]


def figures(found: Sequence[Advice]) -> list[dict[str, Any]]:
    """Return what `--json` writes: `joint`, `pose` (rad), `measured_share` (1) and `lever_arm` (m) of each."""
    return [
        {
            "joint": each.joint + 1,
            "pose": each.pose,
            "measured_share": each.measured_share,
            "lever_arm": each.lever_arm,
        }
        for each in found
    ]
