"""Experiments of several poses put together: which model of a joint counts, and the whole arm's compliances."""

from collections.abc import Sequence

import numpy as np

from calibration.joint_clamping.full_stiffness import ArmStiffness, Clamping, fit_stiffness, told_apart
from calibration.joint_clamping.results import RAW, Clamped, JointResult, deflection, seen_tool, slope_over
from ctlblocks.recording import Recording
from stagectl.robot.arm import Arm


def experiment(recorded: Recording, result: JointResult, clamped: Clamped) -> Clamping:
    """Return what one joint's recording says of the whole arm: slopes over its spring's torque.

    Parameters
    ----------
    recorded : Recording
    result : JointResult
        Of that recording.
    clamped : Clamped
    """
    joint, model = result.joint, result.models[RAW]
    names = [f"angle_{place + 1}" for place in range(clamped.arm.joints)]
    angle = recorded.select(names).data.astype(float)
    bears = model.spring_torque(angle[:, joint]) - model.offset
    slope = slope_over(angle, bears)
    slope[joint] = 0.5 * (1 / model.k_plus.value + 1 / model.k_minus.value)
    tool = seen_tool(recorded)
    if tool is None:
        return Clamping(clamped.pose, joint, slope, environment=clamped.environment)
    return Clamping(clamped.pose, joint, slope, slope_over(deflection(tool), bears))


def whole_arm(arm: Arm, experiments: Sequence[Clamping]) -> ArmStiffness | str:
    """Fit all compliances of the arm, or say why that cannot be.

    Parameters
    ----------
    arm : Arm
    experiments : sequence of Clamping
    """
    wanted = int(told_apart(arm).sum())
    never = sorted(set(range(arm.joints)) - {each.joint for each in experiments})
    if never or len(experiments) <= wanted:
        return (
            f"Not enough for the compliances across the joints: {len(experiments)} experiments, must be more than "
            f"{wanted} and with every joint."
        )
    return fit_stiffness(arm, experiments)


def stiffest(results: Sequence[JointResult]) -> list[JointResult]:
    """Return for each joint, in their order, the result that underestimates least: the one that looks stiffest."""
    joints = dict.fromkeys(result.joint for result in results)
    return [max((each for each in results if each.joint == joint), key=_stiffness) for joint in joints]


def _stiffness(result: JointResult) -> float:
    _, model = result.best
    return float(np.hypot(model.k_plus.value, model.k_minus.value))
