"""A velocity model for a robot that was not identified yet: that of the simulated IRB140."""

import numpy as np

from calibration.state_space.model import InnovationModel

POLES = (0.7690 + 0.2751j, 0.7079)
"""Of order 3 at 250 samples/s, as `calibrate velocity` finds them."""
WEIGHTS = (-0.1119 - 0.1695j, 0.2008)
"""By what each adds to the velocity, before the gain at rest is made one."""
GAINS = (-0.367 + 0.341j, 1.698)
"""Of the innovations, in the same coordinates."""
NOISE = 8e-4
"""m/s rms of the innovations."""


def nominal_velocity(rate: float) -> InnovationModel:
    """Return the model from the velocity asked of the robot to its velocity, m/s, at 250 samples/s.

    Raises
    ------
    ValueError : another rate.
    """
    if rate != 250.0:
        raise ValueError(f"the nominal velocity model is of 250 samples/s, must be of {rate:g}: identify one")
    pair, single = POLES
    transition = np.array([[pair.real, pair.imag, 0.0], [-pair.imag, pair.real, 0.0], [0.0, 0.0, single.real]])
    inlet = np.array([[2.0 * WEIGHTS[0].real], [-2.0 * WEIGHTS[0].imag], [WEIGHTS[1].real]])
    gain = np.array([[2.0 * GAINS[0].real], [-2.0 * GAINS[0].imag], [GAINS[1].real]])
    outlet = np.array([[1.0, 0.0, 1.0]])
    resting = (outlet @ np.linalg.solve(np.eye(3) - transition, inlet))[0, 0]
    noise = np.full((1, 1), NOISE**2)
    names = ("velocity_reference",), ("velocity",), ("m/s",), ("m/s",)
    return InnovationModel(transition, inlet / resting, outlet, np.zeros((1, 1)), gain, rate, noise, *names)
