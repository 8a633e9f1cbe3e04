"""A flextensional shell in water: an elliptical ring that bends, the water that moves with it, the sound it makes."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

WATER_DENSITY, SOUND_SPEED = 1000.0, 1500.0
"""kg/m^3 and m/s."""
NODES = 48
"""Of the ring's finite elements."""


@dataclass(frozen=True)
class Ring:
    """An elliptical ring as a closed frame of straight beams.

    Parameters
    ----------
    major, minor : float, m
        Half axes.
    thickness : array, shape (NODES,), m
        Of each beam; the first begins at the end of the major axis.
    height : float, m
        Along the cylinder's axis.
    density, modulus : float, kg/m^3 and Pa
    ends : float, kg
        What of the driver moves with either end of the major axis.
    """

    major: float
    minor: float
    thickness: np.ndarray
    height: float
    density: float
    modulus: float
    ends: float

    @property
    def radius(self) -> float:
        """The circle of the same area, m."""
        return float(np.sqrt(self.major * self.minor))


@dataclass(frozen=True)
class RingModes:
    """Wet modes of a ring, mass-normalised.

    Parameters
    ----------
    omega : array, shape (modes,), rad/s
    normal : array, shape (NODES, modes), 1/sqrt(kg)
        Motion along the outward normal.
    plane : array, shape (NODES, 2, modes), 1/sqrt(kg)
        Motion along the major and the minor axis.
    volume : array, shape (modes,), m^2/sqrt(kg)
        What the surface displaces.
    area : float, m^2
        The wet surface.
    """

    omega: np.ndarray
    normal: np.ndarray
    plane: np.ndarray
    volume: np.ndarray
    area: float


def ring_modes(ring: Ring, springs: list[tuple[np.ndarray, float]], count: int) -> RingModes:
    """Return the lowest modes of a ring in water.

    Parameters
    ----------
    ring : Ring
    springs : list of (array of shape (3 NODES,), float)
        Springs, N/m, each with the combination of degrees of freedom that stretches it; `chord` and `mount` make some.
    count : int
        Modes wanted.

    Source
    ------
    Sherman and Butler, Transducers and Arrays for Underwater Sound (2007), chapter 3, flextensional transducers;
    Przemieniecki, Theory of Matrix Structural Analysis (1968), for the beam; Junger and Feit, Sound, Structures, and
    Their Interaction (1986), for the water that moves with n waves around a cylinder: rho r / n per area.
    """
    mass, stiffness = _frame(ring)
    mass += _water(ring)
    for node in (0, NODES // 2):
        for axis in range(2):
            mass[3 * node + axis, 3 * node + axis] += ring.ends
    for stretch, spring in springs:
        stiffness += spring * np.outer(stretch, stretch)
    squares, shapes = eigh(stiffness, mass, subset_by_index=(0, count - 1))
    normal, length = _normals(ring)
    plane = shapes.reshape(NODES, 3, -1)[:, :2]
    outward = np.einsum("na,nam->nm", normal, plane)
    surface = length * ring.height
    return RingModes(np.sqrt(np.maximum(squares, 0.0)), outward, plane, surface @ outward, float(surface.sum()))


def chord(one: int, other: int, ring: Ring) -> np.ndarray:
    """Return the degrees of freedom that stretch a line between two nodes, shape (3 NODES,), 1."""
    places = _places(ring)
    along = (places[one] - places[other]) / np.linalg.norm(places[one] - places[other])
    stretch = np.zeros((NODES, 3))
    stretch[one, :2], stretch[other, :2] = along, -along
    return stretch.ravel()


def mount(node: int, axis: int) -> np.ndarray:
    """Return the degree of freedom that stretches a spring between a node and the ground, shape (3 NODES,), 1."""
    stretch = np.zeros((NODES, 3))
    stretch[node, axis] = 1.0
    return stretch.ravel()


def radiation(area: float) -> tuple[float, float]:
    """Return what sound pulls away from a small source, N s/m per m^4 of volume squared, and its corner, 1/s.

    A sphere of the same surface: p = rho c (u - s), s' = (c / a)(u - s) with u the mean normal velocity, which is
    rho c j k a / (1 + j k a) exactly; below the corner it is the mass of the water around, above it a resistance.

    Parameters
    ----------
    area : float, m^2

    Source
    ------
    Sherman and Butler (2007), chapter 10: the pulsating sphere.
    """
    sphere = np.sqrt(area / (4 * np.pi))
    return WATER_DENSITY * SOUND_SPEED / area, SOUND_SPEED / sphere


def _places(ring: Ring) -> np.ndarray:
    angle = 2 * np.pi * np.arange(NODES) / NODES
    return np.stack([ring.major * np.cos(angle), ring.minor * np.sin(angle)], axis=1)


def _normals(ring: Ring) -> tuple[np.ndarray, np.ndarray]:
    """Return outward normals, shape (NODES, 2), and the lengths of wall that belong to the nodes, m."""
    places = _places(ring)
    along = np.roll(places, -1, axis=0) - np.roll(places, 1, axis=0)
    length = np.linalg.norm(along, axis=1)
    normal = np.stack([along[:, 1], -along[:, 0]], axis=1) / length[:, None]
    return normal, length / 2


def _frame(ring: Ring) -> tuple[np.ndarray, np.ndarray]:
    """Return mass and stiffness of the dry ring, shape (3 NODES, 3 NODES)."""
    places, node = _places(ring), np.arange(NODES)
    step = np.roll(places, -1, axis=0) - places
    length = np.linalg.norm(step, axis=1)
    turn = np.zeros((NODES, 6, 6))
    for end in (0, 3):
        turn[:, end, end] = turn[:, end + 1, end + 1] = step[:, 0] / length
        turn[:, end, end + 1], turn[:, end + 1, end] = step[:, 1] / length, -step[:, 1] / length
        turn[:, end + 2, end + 2] = 1.0
    which = (3 * np.stack([node, (node + 1) % NODES], axis=1)[:, :, None] + np.arange(3)).reshape(NODES, 6)
    wholes = np.zeros((2, 3 * NODES, 3 * NODES))
    for whole, part in zip(wholes, _beams(ring, length), strict=True):
        np.add.at(whole, (which[:, :, None], which[:, None, :]), turn.swapaxes(1, 2) @ part @ turn)
    return wholes[0], wholes[1]


def _beams(ring: Ring, length: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return consistent mass and stiffness of the beams, (NODES, 6, 6), for (along, across, turn) at both ends."""
    face = ring.height * ring.thickness
    scale = np.ones((NODES, 6))
    scale[:, [2, 5]] = length[:, None]  # with turns times the length, the matrices are numbers
    across = np.ix_([1, 2, 4, 5], [1, 2, 4, 5])
    along = np.ix_([0, 3], [0, 3])
    mass, bending = np.zeros((2, 6, 6))
    bending[across] = BENDING
    mass[across], mass[along] = ACROSS / 420, np.array([[2, 1], [1, 2]]) / 6
    stretching = np.zeros((6, 6))
    stretching[along] = [[1, -1], [-1, 1]]
    stiffness = (
        ring.modulus * ring.height * (ring.thickness**3 / (12 * length**3))[:, None, None] * bending
        + ring.modulus * (face / length)[:, None, None] * stretching
    )
    both = scale[:, :, None] * scale[:, None, :]
    return ring.density * (face * length)[:, None, None] * mass * both, stiffness * both


BENDING = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]])
ACROSS = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]])
"""1: stiffness and 420 times mass of a beam across itself [Przemieniecki 1968]."""


def _water(ring: Ring) -> np.ndarray:
    """Return the mass of the water around, shape (3 NODES, 3 NODES): rho r / n on n waves of the normal motion."""
    normal, length = _normals(ring)
    waves = np.minimum(np.arange(NODES), NODES - np.arange(NODES))
    gain = np.where(waves > 0, 1.0 / np.maximum(waves, 1), 0.0)
    around = np.fft.ifft(gain[:, None] * np.fft.fft(np.eye(NODES), axis=0), axis=0).real
    root = np.sqrt(length * ring.height)
    between = WATER_DENSITY * ring.radius * root[:, None] * around * root
    full = np.zeros((NODES, 3, NODES, 3))
    full[:, :2, :, :2] = normal[:, :, None, None] * between[:, None, :, None] * normal[None, None]
    return full.reshape(3 * NODES, 3 * NODES)
