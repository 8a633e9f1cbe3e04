"""Whether friction is known at the speeds of a path: told before it is run."""

import numpy as np

from stagectl.experiments.trials.tool_path import RATE
from stagectl.experiments.trials.trial import Trial
from stagectl.robot.milling.friction_range import smoothed_speeds

FASTER = 1.3
"""By so much corrections and the cut make a joint faster than on its path."""


def refuse_unknown_speeds(first: Trial, known: np.ndarray, smoothing: float, source: str) -> None:
    """Refuse a path on which a joint may be faster than its friction is known, by ValueError.

    Parameters
    ----------
    first : Trial
        The first trial of the path.
    known : array, shape (6,), rad/s
    smoothing : float, s
        Time constant of the low-pass behind which these speeds were seen.
    source : str
        What tells friction, for the refusal.
    """
    wanted = FASTER * np.abs(smoothed_speeds(first.joints, RATE, smoothing)).max(axis=0)
    joint = int(np.argmin(known - wanted))
    if known[joint] < wanted[joint]:
        raise ValueError(
            f"{source} gives the friction of joint {joint + 1} at up to {known[joint]:.3g} rad/s, must be >= "
            f"{wanted[joint]:.3g} rad/s, the speed that milling may need: raise friction.speed, which "
            "limits.tool_speed bounds as well, or lower pocket.feed"
        )
