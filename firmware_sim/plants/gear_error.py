"""Gears whose error repeats with the angle: what each turn of a crank and of a motor adds to a joint."""

import numpy as np

LARGEST = 0.145e-3
"""rad, half of what the error of a precision gear for robots may span, one arc minute [GB/T 37718-2019]."""
SMALLEST = 0.5
"""Of that, at least, on any joint."""
CRANK, MOTOR = (40, 60), (120, 250)
"""Turns for each of the joint: of the cycloid's crank, and of the motor."""


def draw_gear_error(seed: int, scale: float) -> np.ndarray:
    """Return a gear's error for each of six joints, shape (2, 3, 6): rad, turns a turn and rad.

    For crank and motor the amplitude, how often it comes in a turn, and where it begins; crank and motor have half of
    the error each.

    Parameters
    ----------
    seed : int
    scale : float, 1
        Of all amplitudes.
    """
    rng = np.random.default_rng([seed, 6])
    drawn = np.empty((2, 3, 6))
    drawn[:, 0] = 0.5 * scale * LARGEST * rng.uniform(SMALLEST, 1.0, 6)
    for row, turns in enumerate((CRANK, MOTOR)):
        drawn[row, 1] = rng.integers(*turns, 6)
    drawn[:, 2] = rng.uniform(0.0, 2 * np.pi, (2, 6))
    return drawn
