"""A thin cylindrical shell, free at both ends, with masses on springs at points of it: modes from geometry."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import eigh

HALF_WAVES = 4
"""Axial families beyond the two inextensional ones: those of a free beam with 2, 3, ... nodes."""
MOST_WAVES = 14
"""Waves around the circumference."""


@dataclass(frozen=True)
class Cylinder:
    """A shell's geometry and material.

    Parameters
    ----------
    radius, length, thickness : float, m
    density : float, kg/m^3
    modulus : float, Pa
    poisson : float, 1
    """

    radius: float
    length: float
    thickness: float
    density: float
    modulus: float
    poisson: float

    @property
    def mass(self) -> float:
        """Its mass, kg."""
        return 2 * np.pi * self.radius * self.length * self.thickness * self.density


@dataclass(frozen=True)
class ShellModes:
    """Modes of a free shell, each with its pattern; rigid bodies first, at 0 Hz.

    Parameters
    ----------
    waves : int array, shape (modes,)
        Around the circumference.
    family : int array, shape (modes,)
        0 as at every place along the axis, 1 linear in it, 2, 3, ... a free beam's.
    turned : array, shape (modes,), rad
        Where the pattern cos(waves (angle - turned)) has its maximum.
    omega : array, shape (modes,), rad/s
    mass : array, shape (modes,), kg
        Generalised, for a radial amplitude of one.
    """

    waves: np.ndarray
    family: np.ndarray
    turned: np.ndarray
    omega: np.ndarray
    mass: np.ndarray

    def with_omega(self, omega: np.ndarray) -> "ShellModes":
        """Return the modes at other frequencies, shape (modes,), rad/s."""
        return replace(self, omega=omega)

    def lowest(self, count: int) -> "ShellModes":
        """Return the lowest so many."""
        kept = np.sort(np.argsort(self.omega, kind="stable")[:count])
        return ShellModes(*(getattr(self, name)[kept] for name in self.__dataclass_fields__))

    def radial(self, angle: np.ndarray, place: np.ndarray) -> np.ndarray:
        """Return the mass-normalised radial motion, shape (points, modes), 1/sqrt(kg).

        Parameters
        ----------
        angle : array, shape (points,), rad
        place : array, shape (points,), 1
            Along the axis, -0.5 to 0.5 of the length.
        """
        around = np.cos(self.waves * (angle[:, None] - self.turned))
        along = np.stack([axial(family, place) for family in self.family], axis=1)
        shape: np.ndarray = around * along / np.sqrt(self.mass)
        return shape


def shell_modes(shell: Cylinder, turned: np.ndarray) -> ShellModes:
    """Return the modes of a free cylinder, each pattern twice, a quarter wave apart.

    Parameters
    ----------
    shell : Cylinder
    turned : array, shape (MOST_WAVES,), rad
        How the pattern of 1, 2, ... waves is turned; imperfections decide that.

    Source
    ------
    Blevins, Formulas for Natural Frequency and Mode Shape (1979), chapter 12: Rayleigh's and Love's inextensional
    modes; free-free beam functions along the axis for the others, with Donnell's membrane term, Morley's bending term
    and the inertia of the tangential motion w / waves, so that all meet Rayleigh's where the waves are long.
    """
    rows = [row for waves in range(1, MOST_WAVES + 1) for row in _families(shell, waves)]
    waves, family, omega, mass = (np.array(column) for column in zip(*rows, strict=True))
    angle = turned[waves - 1]
    both = [np.concatenate([each, each]) for each in (waves, family, omega, mass)]
    quarter = np.concatenate([angle, angle + np.pi / (2 * waves)])
    return ShellModes(both[0], both[1], quarter, both[2], both[3])


def _families(shell: Cylinder, waves: int) -> list[tuple[int, int, float, float]]:
    """Return number of waves, axial family, rad/s and kg of a pattern's modes."""
    speed = np.sqrt(shell.modulus / (shell.density * (1 - shell.poisson**2)))
    ring, slim = speed / shell.radius, shell.thickness**2 / (12 * shell.radius**2)
    inertia, stretch = 1 + 1 / waves**2, (shell.radius / shell.length) ** 2
    half = shell.mass / 2
    rayleigh = ring * np.sqrt(slim * (waves**2 - 1) ** 2 / inertia)
    if waves == 1:
        pitch = shell.mass * (shell.length**2 / 12 + shell.radius**2 / 2) / (shell.length / 2) ** 2
        rows = [(1, 0, 0.0, shell.mass), (1, 1, 0.0, pitch)]
    else:
        tilt = 12 * stretch / (waves**2 * (waves**2 + 1))
        love = rayleigh * np.sqrt((1 + 24 * (1 - shell.poisson) * stretch / waves**2) / (1 + tilt))
        rows = [(waves, 0, rayleigh, half * inertia), (waves, 1, love, half * inertia * (1 + tilt) / 3)]
    for order in range(HALF_WAVES):
        along = BEAM[order] * shell.radius / shell.length
        membrane = (1 - shell.poisson**2) * along**4 / (waves**2 + along**2) ** 2
        bending = slim * (waves**2 + along**2 - 1) ** 2
        rows.append((waves, 2 + order, ring * np.sqrt((membrane + bending) / inertia), half * inertia))
    return rows


BEAM = np.array([4.730041, 7.853205, 10.995608, 14.137165])
"""Roots of cos(b) cosh(b) = 1, those of a free beam [Blevins 1979, table 8-1]."""


def axial(family: int, place: np.ndarray) -> np.ndarray:
    """Return a family's pattern along the axis, shape (points,), 1, at `place`, shape (points,) 1: -0.5 to 0.5."""
    if family == 0:
        return np.ones(len(place))
    if family == 1:
        return 2 * place
    root = BEAM[family - 2]
    if family % 2 == 0:
        even: np.ndarray = np.cos(root * place) / np.cos(root / 2) + np.cosh(root * place) / np.cosh(root / 2)
        return even
    odd: np.ndarray = np.sin(root * place) / np.sin(root / 2) + np.sinh(root * place) / np.sinh(root / 2)
    return odd


def coupled_modes(
    omega: np.ndarray, places: np.ndarray, masses: np.ndarray, springs: np.ndarray, ties: np.ndarray, tie: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the modes of a structure with masses on springs on it, itself tied within and to the ground.

    Parameters
    ----------
    omega : array, shape (modes,), rad/s
        Of the structure alone.
    places : array, shape (masses, modes), 1/sqrt(kg)
        How its mass-normalised modes move under each mass.
    masses, springs : arrays, shape (masses,), kg and N/m
    ties : array, shape (ties, modes), 1/sqrt(kg)
        How the modes stretch the springs that hold it.
    tie : array, shape (ties,), N/m
        Their stiffness.

    Returns
    -------
    omega : array, shape (modes + masses,), rad/s
    shapes : array, shape (modes + masses, modes + masses)
        Columns are the new modes in terms of the structure's (1) and the masses' (1/sqrt(kg)) coordinates.
    """
    count = len(omega)
    stretch = np.concatenate([-places.T, np.eye(len(masses))])
    stiffness = (stretch * springs) @ stretch.T
    stiffness[:count, :count] += np.diag(omega**2) + (ties.T * tie) @ ties
    squares, shapes = eigh(stiffness, np.diag(np.concatenate([np.ones(count), masses])))
    return np.sqrt(np.maximum(squares, 0.0)), shapes
