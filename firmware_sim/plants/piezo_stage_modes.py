"""The stage's mechanics as a table of modes: levers, plate and what rides on it for each axis, and small flexure."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

PIEZO_STIFFNESS = 600e6
"""N/m of a stack, short-circuited: 60 kN blocked at 100 um, of the class that bears the thesis' 30 kN."""
LEVER_MASS = 6.0
"""kg, lever and a third of the stack as the stack feels them: 0.2 kg at the lever's tip times the ratio squared."""
GUIDE_STIFFNESS = 0.25e6
"""N/m, the solid-state joints that guide the plate."""
LEVER_RATIOS = (5.2, 5.0, 4.8)
"""1, tip over stack, x y z; the guide's reaction takes 5 % of it."""
TIP_STIFFNESS = (5.2e6, 5.0e6, 5.0e6)
"""N/m, between the lever's tip and what it carries."""
PLATE_MASSES = (17.5, 15.0, 20.5)
"""kg that move with the plate; the axes are in series, so each carries more or less of the others."""
RIDERS = (((6.0, 84.0), (3.0, 110.0)), ((5.0, 98.0),), ())
"""(kg, Hz when the plate is held) for each axis: the spindle in its mount, and an inner stage across its guide."""
COUPLING_STIFFNESS, COUPLING_MASS = 0.08e6, 0.4
"""N/m and kg between x and z: the guides' skew, and the spindle's centre of mass off the plate's."""
MASS_SPREAD, STIFFNESS_SPREAD, RATIO_SPREAD = 0.02, 0.03, 0.01
"""Relative standard deviation from stage to stage, cut off at two of it."""

MAIN_DAMPING, FLEXURAL_DAMPING, LEVER_DAMPING = (0.010, 0.020), (0.006, 0.015), (0.04, 0.06)
"""Damping ratios below 150 Hz, of the small modes, and of the lever on the stack: bolted joints, cables, ceramic."""
MAIN_BAND, FLEXURAL_BAND = 150.0, (170.0, 900.0)
"""Hz."""
FLEXURAL_MODES, FLEXURAL_SHARE = 4, (0.002, 0.008)
"""Small modes an axis, and the part of the axis' static gain and compliance that each has."""
FLEXURAL_LEAK = 0.2
"""1: what the other of x and z sees of a small mode."""

X, Y, Z = range(3)


@dataclass(frozen=True)
class StageModes:
    """Mass-normalised modes of the whole stage, its stacks short-circuited.

    `frequency` (Hz) and `damping` (ratio) have shape (modes,); `extension` (the stacks, x y z) and `plate` (the end
    effector against the base) have shape (3, modes), 1/sqrt(kg).
    """

    frequency: np.ndarray
    damping: np.ndarray
    extension: np.ndarray
    plate: np.ndarray


def stage_modes(rng: np.random.Generator, coupling: float, frequency_scale: float) -> StageModes:
    """Draw one stage.

    Parameters
    ----------
    rng : Generator
    coupling : float, 1
        Scales what couples x and z.
    frequency_scale : float, 1
        Multiplies the frequencies and, that compliance stays, the shapes.
    """
    frequency, extension, plate = _assembly(rng, coupling)
    small_frequency, small_extension, small_plate = _flexure(rng, coupling, plate, frequency)
    bounds = np.where((frequency < MAIN_BAND)[:, None], MAIN_DAMPING, LEVER_DAMPING)
    damping = rng.uniform(*bounds.T)
    small_damping = rng.uniform(*FLEXURAL_DAMPING, len(small_frequency))
    return StageModes(
        frequency_scale * np.concatenate([frequency, small_frequency]),
        np.concatenate([damping, small_damping]),
        frequency_scale * np.concatenate([extension, small_extension], axis=1),
        frequency_scale * np.concatenate([plate, small_plate], axis=1),
    )


def _assembly(rng: np.random.Generator, coupling: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return frequencies, stack and plate shapes of the lumped stage; coordinates: stack, plate, riders of x, y, z."""
    first = np.cumsum([0, *(2 + len(riders) for riders in RIDERS)])
    mass, stiffness = np.zeros((2, first[-1], first[-1]))
    unit = np.eye(first[-1])

    def spring(elongation: np.ndarray, value: float) -> None:
        stiffness[:] += value * _spread(rng, STIFFNESS_SPREAD) * np.outer(elongation, elongation)

    for axis, riders in enumerate(RIDERS):
        stack, plate = first[axis], first[axis] + 1
        mass[stack, stack] = LEVER_MASS * _spread(rng, MASS_SPREAD)
        mass[plate, plate] = PLATE_MASSES[axis] * _spread(rng, MASS_SPREAD)
        ratio = LEVER_RATIOS[axis] * _spread(rng, RATIO_SPREAD)
        stiffness[stack, stack] += PIEZO_STIFFNESS
        spring(unit[plate] - ratio * unit[stack], TIP_STIFFNESS[axis])
        spring(unit[plate], GUIDE_STIFFNESS)
        for rider, (weight, frequency) in enumerate(riders, start=plate + 1):
            mass[rider, rider] = weight * _spread(rng, MASS_SPREAD)
            spring(unit[rider] - unit[plate], weight * (2 * np.pi * frequency) ** 2)
    _cross(stiffness, first[X] + 1, first[Z] + 1, coupling * COUPLING_STIFFNESS * _spread(rng, STIFFNESS_SPREAD))
    _cross(mass, first[X] + 2, first[Z] + 1, coupling * COUPLING_MASS * _spread(rng, MASS_SPREAD))
    squares, shapes = eigh(stiffness, mass)
    shapes *= np.sign(shapes[np.abs(shapes).argmax(axis=0), np.arange(len(shapes))])  # LAPACK leaves the sign open
    return np.sqrt(squares) / (2 * np.pi), shapes[first[:-1]], shapes[first[:-1] + 1]


def _cross(matrix: np.ndarray, a: int, b: int, value: float) -> None:
    matrix[a, b] += value
    matrix[b, a] += value


def _flexure(
    rng: np.random.Generator, coupling: float, plate: np.ndarray, frequency: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Draw the small modes: each a share of its axis' static compliance, with a share of its gain of either sign."""
    compliance = np.sum((plate / (2 * np.pi * frequency)) ** 2, axis=1)  # m/N
    drawn = np.sort(rng.uniform(*FLEXURAL_BAND, (3, FLEXURAL_MODES)), axis=1)
    small_plate, small_extension = np.zeros((2, 3, 3 * FLEXURAL_MODES))
    for axis in (X, Y, Z):
        own = slice(axis * FLEXURAL_MODES, (axis + 1) * FLEXURAL_MODES)
        omega = 2 * np.pi * drawn[axis]
        share, sign = rng.uniform(*FLEXURAL_SHARE, FLEXURAL_MODES), rng.choice([-1.0, 1.0], FLEXURAL_MODES)
        shape = omega * np.sqrt(share * compliance[axis])
        small_plate[axis, own] = shape
        small_extension[axis, own] = sign * share * LEVER_RATIOS[axis] * omega**2 / (PIEZO_STIFFNESS * shape)
        if axis != Y:
            leak = coupling * FLEXURAL_LEAK * rng.uniform(-1.0, 1.0, FLEXURAL_MODES)
            small_plate[X + Z - axis, own] = leak * shape
    return drawn.ravel(), small_extension, small_plate


def _spread(rng: np.random.Generator, deviation: float) -> float:
    return float(1 + deviation * np.clip(rng.standard_normal(), -2, 2))
