"""Whether a log's torques can be what they are read as: by what holds the arm up."""

import numpy as np

from stagectl.robot.milling.force_model import ForceModel
from stagectl.robot.milling.torque_log import TorqueLog, TorqueLogError

TIMES_FRICTION = 50.0
"""A median torque beyond so many times the largest friction is no force that a tool is pushed with."""
HEAVY = 2.0
"""Times its largest friction, that a joint has to bear for the sign of its torque to be told by it."""
REVERSED = -0.5
"""Of what holds the arm up, at most, where a torque's sign is reversed: a force of the tool hides that no more."""
SILENT = 0.05
"""Of it, at most, where no torque is told at all."""


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
    told, held = log.torque[seen], model.gravity.torque(model.arm, log.joint_angle[seen])
    left = np.median(np.abs(told - held), axis=0)
    most = np.maximum(np.abs(model.friction.low), np.abs(model.friction.high)).max(axis=0)
    wrong = np.flatnonzero(left > TIMES_FRICTION * most)
    if len(wrong):
        joint = int(wrong[0])
        raise TorqueLogError(
            f"the torque of joint {joint + 1} is {left[joint]:.3g} N m off what holds the arm up, its friction is at "
            f"most {most[joint]:.3g} N m: torques must be in N m on the joints' side of the gears"
        )
    _refuse_other_signs(told, held, most)


def _refuse_other_signs(told: np.ndarray, held: np.ndarray, friction: np.ndarray) -> None:
    """Refuse torques (samples, 6), N m, that hold the arm down, or do not hold it at all.

    Parameters
    ----------
    told, held : arrays, shape (samples, 6), N m
        The log's, and what holds the arm up.
    friction : array, shape (6,), N m
        The largest of each joint.
    """
    power = np.sum(held**2, axis=0)
    heavy = np.flatnonzero(np.sqrt(power / max(len(held), 1)) > HEAVY * friction)
    share = np.sum(told * held, axis=0)[heavy] / power[heavy]
    if wrong := heavy[share < REVERSED].tolist():
        raise TorqueLogError(
            f"the torque's sign appears reversed, of joint {', '.join(str(joint + 1) for joint in wrong)}: it is "
            f"{share.min():.2g} times what holds the arm up; torques must be those of the motors on the arm"
        )
    if len(heavy) and np.abs(share).max() < SILENT:
        raise TorqueLogError(
            f"the torques are at most {np.abs(share).max():.2g} times what holds the arm up: there are none, or they "
            "are in other units; must be in N m on the joints' side of the gears"
        )
