"""Whether a log's torques can be what they are read as: by what holds the arm up."""

import numpy as np

from stagectl.robot.milling.force_model import ForceModel
from stagectl.robot.milling.torque_log import TorqueLog, TorqueLogError

TIMES_FRICTION = 50.0
"""A median torque beyond so many times the largest friction is no force that a tool is pushed with."""


def refuse_other_torques(log: TorqueLog, model: ForceModel) -> None:
    """Refuse a log whose torques do not fit to its angles.

    Parameters
    ----------
    log : TorqueLog
    model : ForceModel

    Raises
    ------
    TorqueLogError : the first joint whose torques do not fit.
    """
    seen = np.isfinite(log.torque[:, 0])
    off = log.torque[seen] - model.gravity.torque(model.arm, log.joint_angle[seen])
    left = np.median(np.abs(off), axis=0)
    most = np.maximum(np.abs(model.friction.low), np.abs(model.friction.high)).max(axis=0)
    wrong = np.flatnonzero(left > TIMES_FRICTION * most)
    if len(wrong):
        joint = int(wrong[0])
        raise TorqueLogError(
            f"the torque of joint {joint + 1} is {left[joint]:.3g} N m off what holds the arm up, its friction is at "
            f"most {most[joint]:.3g} N m: torques must be in N m on the joints' side of the gears"
        )
