"""The vibrator's mechanics as a table of modes: a lumped frame with two coils and two shells, and flexure on top."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

COIL_MASS, SHELL_MASS, FRAME_MASS = 15.0, 60.0, 1500.0
"""kg."""
SHELL_AREA = 0.3
"""m^2 of a shell's face, which radiates."""
SPRING_STIFFNESS = 2.549e6
"""N/m, between coil and shell; with the shell's own it gives the two wanted resonances, near 34 and 76 Hz."""
SHELL_STIFFNESS = 3.674e6
"""N/m, between shell and frame."""
SUSPENSION_FREQUENCY = 6.0
"""Hz, the frame on its suspension."""
MASS_SPREAD, STIFFNESS_SPREAD = 0.02, 0.03
"""Relative standard deviation between the two sides and between seeds."""
JOINT_SHARE = 0.1
"""Part of the shell's motion against the frame that the bolted joints see."""
LUMPED_DAMPING = ((15.0, 0.08), (55.0, 0.05), (np.inf, 0.035))
"""(up to Hz, damping ratio) of the lumped modes."""

LOCAL_PAIRS, LOCAL_BAND = 5, (104.0, 180.0)
"""Flexural modes of one shell and its springs; the shells are nearly alike, so they come in pairs."""
GLOBAL_MODES, GLOBAL_BAND = 27, (180.0, 640.0)
"""Flexural modes of the whole, in the band that is looked at ..."""
UPPER_MODES, UPPER_BAND = 5, (670.0, 1300.0)
"""... and above it, whose stiffness is felt below."""
LOCAL_DAMPING, FLEXURAL_DAMPING = (0.012, 0.025), (0.006, 0.016)
FLEXURAL_SHAPE, LOCAL_SHAPE, JOINT_SHAPE = 0.028, 0.045, 0.1
"""1/sqrt(kg), size of a flexural mode at coil, spring and shell, of a local one, and of either at the joints."""
LOCAL_LEAK, PAIR_SPREAD = 0.15, 0.03
"""1: what the other side sees of a local mode, and how far the two of a pair lie apart."""


@dataclass(frozen=True)
class Modes:
    """Mass-normalised modes.  Shapes are arrays (2 sides, modes), 1/sqrt(kg).

    `frequency` (Hz) and `damping` (ratio) have shape (modes,).  `coil` is the coil against the frame, where its force
    acts; `spring` the coil against the shell; `joint` the slip of the bolted joints; `shell` the accelerometer.
    """

    frequency: np.ndarray
    damping: np.ndarray
    coil: np.ndarray
    spring: np.ndarray
    joint: np.ndarray
    shell: np.ndarray


def vibrator_modes(rng: np.random.Generator) -> Modes:
    """Draw one vibrator in air: no two have the same masses, springs and flexure."""
    return joined(lumped_modes(rng, 0.0), flexural_modes(rng))


def joined(*parts: Modes) -> Modes:
    """Put the modes of several tables into one."""
    return Modes(*(np.concatenate([getattr(part, name) for part in parts], axis=-1) for name in Modes.__annotations__))


def lumped_modes(rng: np.random.Generator, fluid_mass: float) -> Modes:
    """Draw coil 1, shell 1, coil 2, shell 2 and the frame: five degrees of freedom.

    Parameters
    ----------
    rng : Generator
    fluid_mass : float, kg
        What moves with each shell.
    """
    frame = 4
    mass, stiffness = np.zeros(5), np.zeros((5, 5))
    for coil, shell in ((0, 1), (2, 3)):
        scatter = rng.standard_normal(4)
        mass[coil] = COIL_MASS * (1 + MASS_SPREAD * scatter[0])
        mass[shell] = SHELL_MASS * (1 + MASS_SPREAD * scatter[1]) + fluid_mass
        _add_spring(stiffness, coil, shell, SPRING_STIFFNESS * (1 + STIFFNESS_SPREAD * scatter[2]))
        _add_spring(stiffness, shell, frame, SHELL_STIFFNESS * (1 + STIFFNESS_SPREAD * scatter[3]))
    mass[frame] = FRAME_MASS
    stiffness[frame, frame] += FRAME_MASS * (2 * np.pi * SUSPENSION_FREQUENCY) ** 2
    squares, shape = eigh(stiffness, np.diag(mass))
    shape *= np.sign(shape[np.abs(shape).argmax(axis=0), np.arange(5)])  # LAPACK leaves the sign open
    frequency = np.sqrt(squares) / (2 * np.pi)
    damping = np.array([next(ratio for limit, ratio in LUMPED_DAMPING if f < limit) for f in frequency])
    coil, shell = shape[[0, 2]], shape[[1, 3]]
    return Modes(frequency, damping, coil - shape[frame], coil - shell, JOINT_SHARE * (shell - shape[frame]), shell)


def _add_spring(stiffness: np.ndarray, a: int, b: int, value: float) -> None:
    stiffness[[a, b], [a, b]] += value
    stiffness[[a, b], [b, a]] -= value


def flexural_modes(rng: np.random.Generator) -> Modes:
    """Draw shell and spring flexure: in pairs of one side each at the lower end, of both sides above."""
    pairs = np.repeat(_spread(rng, LOCAL_PAIRS, LOCAL_BAND), 2) * (
        1 + rng.uniform(-0.5, 0.5, 2 * LOCAL_PAIRS) * PAIR_SPREAD
    )
    upper = np.sort(rng.uniform(*UPPER_BAND, UPPER_MODES))
    frequency = np.concatenate([pairs, _spread(rng, GLOBAL_MODES, GLOBAL_BAND), upper])
    count = len(frequency)
    weight, size = np.ones((2, count)), np.full(count, FLEXURAL_SHAPE)
    size[: len(pairs)] = LOCAL_SHAPE
    weight[1, : len(pairs) : 2] = weight[0, 1 : len(pairs) : 2] = LOCAL_LEAK

    def shape() -> np.ndarray:
        sign = rng.choice([-1.0, 1.0], (2, count))
        shape: np.ndarray = size * weight * sign * rng.uniform(0.5, 1.5, (2, count))
        return shape

    damping = rng.uniform(*FLEXURAL_DAMPING, count)
    damping[: len(pairs)] = rng.uniform(*LOCAL_DAMPING, len(pairs))
    joint = JOINT_SHAPE * weight * rng.standard_normal((2, count))
    return Modes(frequency, damping, shape(), shape(), joint, shape())


def _spread(rng: np.random.Generator, count: int, band: tuple[float, float]) -> np.ndarray:
    """Place `count` modes over a band, one to a slot, anywhere in the first nine tenths of it."""
    slot = (band[1] - band[0]) / count
    return band[0] + slot * (np.arange(count) + rng.uniform(0, 0.9, count))
