"""What a sensor hears beside the machine: mains, noise that is white or rises to low frequencies, a ship going by."""

import math

import numpy as np

from firmware_sim.plants.flush_kernel import flushed
from rigkit.compiled import njit


@njit(cache=True, nogil=True)
def add_mains(heard: np.ndarray, phase: float, advance: float, sines: np.ndarray, cosines: np.ndarray) -> float:
    """Add harmonics to `heard` (frames, sensors) m/s^2 and return the phase, rad, of the sample after.

    `phase` of the first sample and `advance` a sample, rad; `sines` and `cosines` (harmonics, sensors) m/s^2.
    """
    for n in range(heard.shape[0]):
        turn_real, turn_imaginary = math.cos(phase), math.sin(phase)
        real, imaginary = turn_real, turn_imaginary
        for h in range(sines.shape[0]):
            for s in range(heard.shape[1]):
                heard[n, s] += sines[h, s] * imaginary + cosines[h, s] * real
            real, imaginary = (
                real * turn_real - imaginary * turn_imaginary,
                real * turn_imaginary + imaginary * turn_real,
            )
        phase = (phase + advance) % (2.0 * math.pi)
    return phase


@njit(cache=True, nogil=True)
def add_noise(
    heard: np.ndarray,
    white: np.ndarray,
    level: np.ndarray,
    rising: np.ndarray,
    swell: np.ndarray,
    stages: np.ndarray,
    memory: np.ndarray,
) -> None:
    """Add noise of each sensor's own to `heard` (frames, sensors) m/s^2.

    `white` (frames, more) of unit variance has a column a sensor; `level` (sensors,) m/s^2 is of what stays white,
    `rising` (sensors,) m/s^2 of what goes through `stages` (stages, 3: b0, b1, a1), which rises to low frequencies and
    swells: `swell` (2,) 1 is its size at the first sample, which is moved on, and its growth a sample.  `memory`
    (sensors, stages).
    """
    for n in range(heard.shape[0]):
        for s in range(heard.shape[1]):
            value = white[n, s]
            heard[n, s] += level[s] * value
            if rising[s] > 0.0:
                for j in range(stages.shape[0]):
                    shaped = stages[j, 0] * value + memory[s, j]
                    memory[s, j] = flushed(stages[j, 1] * value - stages[j, 2] * shaped)
                    value = shaped
                heard[n, s] += swell[0] * rising[s] * value
        swell[0] += swell[1]


@njit(cache=True, nogil=True)
def add_ship(
    heard: np.ndarray,
    white: np.ndarray,
    gains: np.ndarray,
    size: np.ndarray,
    blade: np.ndarray,
    band: np.ndarray,
    memory: np.ndarray,
) -> None:
    """Add a ship's noise to `heard` (frames, sensors) m/s^2, the same to all but for `gains` (sensors,) 1.

    `white` (frames, more) of unit variance has it in its last column; `size` (2,) m/s^2 is its size at the
    first sample, which is moved on, and its growth a sample; `blade` (3,) holds how deep its propeller modulates it, 1,
    the phase, rad, which is moved on, and its advance a sample; `band` (5,) is a band-pass, `memory` (2,).
    """
    last = white.shape[1] - 1
    for n in range(heard.shape[0]):
        value = white[n, last]
        shaped = band[0] * value + memory[0]
        memory[0] = flushed(band[1] * value - band[3] * shaped + memory[1])
        memory[1] = flushed(band[2] * value - band[4] * shaped)
        shaped *= size[0] * (1.0 + blade[0] * math.sin(blade[1]))
        size[0] += size[1]
        blade[1] = (blade[1] + blade[2]) % (2.0 * math.pi)
        for s in range(heard.shape[1]):
            heard[n, s] += gains[s] * shaped
