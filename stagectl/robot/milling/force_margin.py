"""What torques may hold beside gravity, friction and the force on the tool: noise, a moment, and inertia."""

import numpy as np

from stagectl.robot.learning_config import Margin
from stagectl.robot.milling.torque_kernel import JOINTS

FADE = 0.1
"""s in which an acceleration comes to count for 1/e: an arm that was shaken goes on to ring."""


def packed_margin(margin: Margin, covariance: np.ndarray, inertia: np.ndarray) -> np.ndarray:
    """Return the slack of each joint's torque as the kernel reads it: at rest (N m), then by acceleration (kg m^2).

    A moment of whatever direction turns a joint by no more than its size, the axis being a unit vector.

    Parameters
    ----------
    margin : Margin
    covariance : array, shape (6, 6), (N m)^2
        R_e, of a single sample.
    inertia : array, shape (6,), kg m^2
        Of the joints, as `ForceModel` has it.

    Returns
    -------
    array, shape (2, 6)

    Raises
    ------
    ValueError : an inertia that is none.
    """
    inertia = np.asarray(inertia, float)
    if inertia.shape != (JOINTS,) or not (np.isfinite(inertia) & (inertia >= 0)).all():
        raise ValueError(f"inertia is {inertia}, must be {JOINTS} numbers >= 0 kg m^2")
    return np.stack([margin.noise * np.sqrt(np.diag(covariance)) + margin.moment, margin.inertia * inertia])
