"""What a family of vibrators draws: the structure between coils and sensors."""

from dataclasses import dataclass

import numpy as np

from firmware_sim.plants.structure import Structure
from firmware_sim.population.draw import Quantity

LOWEST, HIGHEST = 8.0, 60.0
"""Hz, of the first resonance."""
FEWEST, MOST = 6, 60
"""Modes."""
DAMPING = (0.002, 0.08)
"""1, ratios."""
TOP = 3000.0
"""Hz: what oscillates faster is left out."""
SLOW = 150.0
"""Hz: up to here a structure has all its modes, for overtones to meet some."""


@dataclass(frozen=True)
class Mechanics:
    """A structure and what its family says of it.

    Parameters
    ----------
    structure : Structure
        Forces: `coils`; the suspension of each coil, at the same place; `joints`.
    coils, joints : int
    quantities : tuple of Quantity
    """

    structure: Structure
    coils: int
    joints: int
    quantities: tuple[Quantity, ...]


def log_uniform(rng: np.random.Generator, low: float, high: float, size: int | None = None) -> np.ndarray:
    """Return numbers whose logarithm is uniform, shape (size,) or ()."""
    drawn: np.ndarray = np.exp(rng.uniform(np.log(low), np.log(high), size))
    return drawn


def modal_damping(rng: np.random.Generator, middle: float, modes: int) -> np.ndarray:
    """Return damping ratios about `middle`, a factor of two to either side at most, shape (modes,), 1."""
    drawn: np.ndarray = np.clip(middle * log_uniform(rng, 0.5, 2.0, modes), *DAMPING)
    return drawn


def lowest_modes(structure: Structure, count: int) -> Structure:
    """Return a structure with its real poles and its lowest oscillations: `count` of them, and all below `SLOW`.

    None is above `TOP`, and there are no more than `MOST`.
    """
    frequency = np.abs(structure.poles) / (2 * np.pi)
    rings = np.flatnonzero((structure.poles.imag > 0) & (frequency < TOP))
    order = rings[np.argsort(frequency[rings], kind="stable")]
    kept = order[: min(max(count, int((frequency[order] < SLOW).sum())), MOST)]
    return structure.kept(np.concatenate([kept, np.flatnonzero(structure.poles.imag == 0)]))
