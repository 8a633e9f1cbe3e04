"""Reaction masses on springs over base plates, and all on one frame: lumped exciters whose springs surge."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Spring:
    """A spring with mass, and a dashpot from end to end.

    Parameters
    ----------
    stiffness : float, N/m
    dashpot : float, N s/m
    mass : float, kg
    lumps : int
        Its mass as so many points, which makes so many surge modes.
    """

    stiffness: float
    dashpot: float
    mass: float
    lumps: int


@dataclass(frozen=True)
class Unit:
    """One exciter.

    Parameters
    ----------
    reaction, plate : float, kg
    upper, lower : Spring
        Between reaction mass and plate, and between plate and frame.
    """

    reaction: float
    plate: float
    upper: Spring
    lower: Spring


class Lumped:
    """Masses along one line, joined by springs and dashpots.

    Source
    ------
    Sallas, Seismic vibrator control and the downgoing P-wave, Geophysics 49 (1984) 732: reaction mass and base plate;
    Wahl, Mechanical Springs (1963), chapter on surge.
    """

    def __init__(self) -> None:
        self._masses: list[float] = []
        self._links: list[tuple[int, int, float, float]] = []

    def body(self, mass: float) -> int:
        """Add a mass, kg, and return its number."""
        self._masses.append(mass)
        return len(self._masses) - 1

    def join(self, one: int, other: int, spring: Spring) -> None:
        """Put a spring between two masses; -1 is the ground."""
        parts = spring.lumps + 1
        ends = [one, *(self.body(spring.mass / spring.lumps) for _ in range(spring.lumps)), other]
        for a, b in zip(ends, ends[1:], strict=False):
            self._links.append((a, b, spring.stiffness * parts, 0.0))
        self._links.append((one, other, 0.0, spring.dashpot))

    def matrices(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return masses, shape (bodies,) kg, stiffness N/m and damping N s/m, shape (bodies, bodies)."""
        count = len(self._masses)
        stiffness, damping = np.zeros((count, count)), np.zeros((count, count))
        for one, other, spring, dashpot in self._links:
            ends = np.zeros(count)
            ends[one] = 1.0
            if other >= 0:
                ends[other] = -1.0
            stiffness += spring * np.outer(ends, ends)
            damping += dashpot * np.outer(ends, ends)
        return np.array(self._masses), stiffness, damping


def two_mass_exciters(
    units: list[Unit], frame: float, suspension: Spring, ties: list[Spring]
) -> tuple[Lumped, list[int], list[int]]:
    """Return the exciters on their frame, and which bodies are reaction masses and plates.

    Parameters
    ----------
    units : list of Unit
    frame : float, kg
    suspension : Spring
        Between frame and ground.
    ties : list of Spring
        Between the plates of neighbours; one fewer than there are units.
    """
    whole = Lumped()
    base = whole.body(frame)
    whole.join(base, -1, suspension)
    reactions, plates = [], []
    for unit in units:
        reactions.append(whole.body(unit.reaction))
        plates.append(whole.body(unit.plate))
        whole.join(reactions[-1], plates[-1], unit.upper)
        whole.join(plates[-1], base, unit.lower)
    for one, other, tie in zip(plates, plates[1:], ties, strict=False):
        whole.join(one, other, tie)
    return whole, reactions, plates


def with_loss(masses: np.ndarray, stiffness: np.ndarray, damping: np.ndarray, loss: float) -> np.ndarray:
    """Return a damping matrix with what every mode loses in its springs beside the dashpots, N s/m.

    Parameters
    ----------
    masses : array, shape (bodies,), kg
    stiffness, damping : arrays, shape (bodies, bodies), N/m and N s/m
    loss : float, 1
        Damping ratio of each mode without dashpots.

    Returns
    -------
    array, shape (bodies, bodies), N s/m
    """
    root = np.sqrt(masses)
    squares, shapes = np.linalg.eigh(stiffness / np.outer(root, root))
    own = (shapes * 2 * loss * np.sqrt(np.maximum(squares, 0.0))) @ shapes.T
    whole: np.ndarray = damping + root[:, None] * own * root
    return whole


def first_order(masses: np.ndarray, stiffness: np.ndarray, damping: np.ndarray) -> np.ndarray:
    """Return A of x' = A x with x the displacements and then the velocities, shape (2 bodies, 2 bodies), 1/s.

    Parameters
    ----------
    masses : array, shape (bodies,), kg
    stiffness, damping : arrays, shape (bodies, bodies), N/m and N s/m
    """
    count = len(masses)
    upper = np.concatenate([np.zeros((count, count)), np.eye(count)], axis=1)
    lower = np.concatenate([-stiffness, -damping], axis=1) / masses[:, None]
    return np.concatenate([upper, lower])
