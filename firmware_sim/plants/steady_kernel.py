"""What the nonlinear laws make of a motion that repeats itself."""

import numpy as np

from firmware_sim.plants.exciter_kernel import amplified, element_force, force_factor
from rigkit.compiled import njit


@njit(cache=True, nogil=True)
def steady_forces(
    longer: np.ndarray, velocity: np.ndarray, law: np.ndarray, step: np.ndarray, periods: int, forces: np.ndarray
) -> None:
    """Fill `forces` (motions, samples) N, of the last of so many periods of each motion.

    `longer` (motions, samples) m and `velocity` m/s are one period; `law` a row of elements; `step` (motions,) s.
    """
    memory = np.zeros((3, 1))
    for motion in range(longer.shape[0]):
        memory[:, :] = 0.0
        for _ in range(periods):
            for n in range(longer.shape[1]):
                forces[motion, n] = element_force(longer[motion, n], velocity[motion, n], law, memory, 0, step[motion])


@njit(cache=True, nogil=True)
def steady_field(displacement: np.ndarray, coil: np.ndarray, factors: np.ndarray) -> None:
    """Fill `factors` (motions, samples) N/A from displacements, m; `coil` is a row of coils."""
    for motion in range(displacement.shape[0]):
        for n in range(displacement.shape[1]):
            factors[motion, n] = force_factor(displacement[motion, n], coil)


@njit(cache=True, nogil=True)
def clip_softly(voltage: np.ndarray, clip: float, sharpness: int, clipped: np.ndarray) -> None:
    """Fill `clipped` (samples, coils) V from what an amplifier would put out that never clips, V."""
    for n in range(voltage.shape[0]):
        for c in range(voltage.shape[1]):
            clipped[n, c] = amplified(voltage[n, c], 1.0, clip, sharpness)
