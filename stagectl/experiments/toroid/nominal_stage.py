"""Models of the simulated stage of seed 1, where nobody has identified one: its modes below 150 Hz."""

import numpy as np
from scipy.linalg import block_diag, expm

from calibration.state_space.model import InnovationModel

MODES = {
    "x": ((57.2, 0.0101, 3.638), (95.8, 0.0184, 0.469), (130.8, 0.0122, 0.835)),
    "y": ((67.2, 0.0165, 3.621), (126.0, 0.0128, 1.158)),
    "z": ((74.1, 0.0172, 4.513),),
}
"""Natural frequency (Hz), damping ratio, and part of the gain at rest (m/m) of each resonance below 150 Hz, from the
inner loop's reference to the plate's position."""
LAG = 600.0
"""Hz: amplifier, delay of the sensors and all faster modes together."""


def nominal_model(axis: str, rate: float) -> InnovationModel:
    """Return the model of an axis, x, y or z, sampled with a held input.

    Parameters
    ----------
    axis : str
    rate : float, samples/s

    Raises
    ------
    ValueError : there is no such axis.
    """
    if axis not in MODES:
        raise ValueError(f"axis is {axis!r}, must be one of {', '.join(MODES)}, or a model file must be given for each")
    rows = np.array(MODES[axis])
    omega, damping, gain = 2 * np.pi * rows[:, 0], rows[:, 1], rows[:, 2]
    blocks = [[[0.0, w], [-w, -2 * z * w]] for w, z in zip(omega, damping, strict=True)]
    lag = 2 * np.pi * LAG
    drift = block_diag(*blocks, [[-lag]])
    drift[1:-1:2, -1] = gain * omega
    drive = np.append(np.zeros(len(drift) - 1), lag)[:, None]
    held = expm(np.block([[drift, drive], [np.zeros((1, len(drift) + 1))]]) / rate)
    seen = np.array([[1.0, 0.0] * len(rows) + [0.0]])
    none, direct = np.zeros((len(drift), 1)), np.zeros((1, 1))
    return InnovationModel(held[:-1, :-1], held[:-1, -1:], seen, direct, none, rate, np.full((1, 1), 1e-16))
