"""The family `flextensional`: elliptical shells in water, driven along their major axes, stacked side by side."""

import numpy as np
from scipy.linalg import eigh

from firmware_sim.plants.flextensional import NODES, WATER_DENSITY, Ring, RingModes, chord, mount, radiation, ring_modes
from firmware_sim.plants.structure import from_state_space
from firmware_sim.population.draw import Quantity
from firmware_sim.population.mechanics import Mechanics, log_uniform, lowest_modes, modal_damping
from firmware_sim.population.streams import Streams

MATERIALS = {"steel": (7850.0, 2.1e11), "aluminium": (2700.0, 7.0e10), "fibreglass": (1900.0, 1.7e10)}
"""kg/m^3 and Pa."""
MAJOR, ASPECT, SLIMNESS, HEIGHT = (0.25, 1.2), (1.2, 3.0), (0.015, 0.15), (0.5, 2.0)
"""m, about; major over minor axis; thickness over the mean radius; height over the major half axis."""
BUMPS = 4
"""Waves of uneven thickness around the ring."""
MOUNTED = (5, 17, 28, 44)
"""Nodes at which each shell hangs, in both directions."""
QUARTER = NODES // 4
JOINTS = 1


def draw_flextensional(streams: Streams, coils: int, sensors: int, first: float, modes: int) -> Mechanics:
    """Draw shells in water, one a coil.

    Parameters
    ----------
    streams : Streams
    coils, sensors : int
    first : float, Hz
        The first resonance.
    modes : int

    Returns
    -------
    Mechanics
    """
    material = list(MATERIALS)[streams("material").integers(len(MATERIALS))]
    rings = _rings(streams, MATERIALS[material], coils, first)
    off = streams("alignment").integers(-1, 2, (coils, 3))
    tables = [
        _table(streams.within(f"ring {n}"), ring, int(off[n, 0]), modes // coils + 4) for n, ring in enumerate(rings)
    ]
    omega, shapes = _stacked(streams, tables)
    keep = slice(0, modes)
    omega, shapes = omega[keep], shapes[:, keep]
    loss = float(log_uniform(streams("loss"), 0.002, 0.03))
    damping = modal_damping(streams("damping"), loss, len(omega))
    ports, heard = _ports(tables, rings, off, sensors)
    volume = np.concatenate([table.volume for table in tables]) @ shapes
    area = sum(table.area for table in tables)
    dynamics, inlet = _in_water(omega, damping, volume, area, (ports @ shapes).T)
    states = np.zeros((len(ports), 2 * len(omega) + 1))
    states[:, : len(omega)] = ports @ shapes
    seen = np.zeros((sensors, 2 * len(omega) + 1))
    seen[:, : len(omega)] = heard @ shapes
    structure = from_state_space(dynamics, inlet, states, seen)
    factor = first / float(structure.frequency.min())
    said = (
        Quantity("material", material),
        Quantity("major half axes", tuple(ring.major / factor for ring in rings), "m"),
        Quantity("minor half axes", tuple(ring.minor / factor for ring in rings), "m"),
        Quantity("height", rings[0].height / factor, "m"),
        Quantity("mean thickness", float(rings[0].thickness.mean()) / factor, "m"),
        Quantity("radiation corner", radiation(area)[1] * factor / (2 * np.pi), "Hz"),
    )
    return Mechanics(lowest_modes(structure.resized(factor), modes), coils, JOINTS, said)


def _rings(streams: Streams, material: tuple[float, float], coils: int, first: float) -> list[Ring]:
    """Draw the shells' geometry: alike but for a few per cent, each uneven in its own way."""
    major = float(log_uniform(streams("major axis"), *MAJOR))
    minor = major / float(streams("aspect").uniform(*ASPECT))
    height = major * float(log_uniform(streams("height"), *HEIGHT))
    radius = np.sqrt(major * minor)
    thickness = radius * _slimness(radius, material, first)
    ends = streams("ends").uniform(0.02, 0.2)
    angle, waves = 2 * np.pi * np.arange(NODES) / NODES, np.arange(1, BUMPS + 1)
    rings = []
    for n in range(coils):
        rng = streams.within(f"ring {n}")("geometry")
        size = 1 + 0.02 * rng.standard_normal(3)
        bumps = 1 + 0.02 * rng.standard_normal(BUMPS) @ np.cos(waves[:, None] * (angle - rng.uniform(0, 6, (BUMPS, 1))))
        around = np.pi * (major + minor) * thickness * height * material[0]
        rings.append(
            Ring(major * size[0], minor * size[1], thickness * size[2] * bumps, height, *material, ends * around)
        )
    return rings


def _slimness(radius: float, material: tuple[float, float], first: float) -> float:
    """Return thickness over radius of a circular ring whose two waves ring at `first` Hz in water, within limits.

    omega^2 = E h^3 / 12 x (n^2 - 1)^2 / r^4 / (rho h (1 + 1 / n^2) + rho_w r / n), n = 2; solved by iteration.
    """
    density, modulus = material
    slim = 0.05
    for _ in range(30):
        load = 1.25 * density * slim + WATER_DENSITY / 2
        slim = float(np.cbrt((2 * np.pi * first * radius) ** 2 * load * 12 / (9 * modulus)))
    return float(np.clip(slim, *SLIMNESS))


def _table(streams: Streams, ring: Ring, off: int, count: int) -> RingModes:
    """Return a ring's modes with a suspension along its coil and on its mounts, all as stiff as the ring, or less."""
    rng = streams("springs")
    free = ring_modes(ring, [], 4)
    wall = 2 * ring.radius * float(ring.thickness.mean()) * ring.density + ring.radius**2 * WATER_DENSITY
    stiff = (np.pi * ring.height * wall + 2 * ring.ends) * free.omega[3] ** 2
    across = chord(0, NODES // 2 + off, ring)
    springs = [(across, stiff * rng.uniform(0.05, 0.5))]
    springs += [(mount(node, axis), stiff * rng.uniform(0.3, 1.0)) for node in MOUNTED for axis in range(2)]
    return ring_modes(ring, springs, count)


def _stacked(streams: Streams, tables: list[RingModes]) -> tuple[np.ndarray, np.ndarray]:
    """Return rad/s and shapes (modes, modes) of shells whose neighbours are tied at two places of their rims."""
    omega = np.concatenate([table.omega for table in tables])
    stiffness = np.diag(omega**2)
    start = np.cumsum([0, *(len(table.omega) for table in tables)])
    rng = streams("ties")
    for n in range(len(tables) - 1):
        for node in rng.integers(NODES, size=2):
            tie = np.zeros(len(omega))
            tie[start[n] : start[n + 1]] = tables[n].normal[node]
            tie[start[n + 1] : start[n + 2]] = -tables[n + 1].normal[node]
            softness = (tie**2 / np.maximum(omega, omega.max() * 1e-3) ** 2).sum()
            stiffness += rng.uniform(0.05, 0.5) / softness * np.outer(tie, tie)
    squares, shapes = eigh(stiffness)
    return np.sqrt(np.maximum(squares, 0.0)), shapes


def _ports(tables: list[RingModes], rings: list[Ring], off: np.ndarray, sensors: int) -> tuple[np.ndarray, np.ndarray]:
    """Return how the modes of all shells move coils, suspensions, the joint and sensors, (ports, modes) each."""
    total, start = sum(len(table.omega) for table in tables), 0
    coil, heard, joint = np.zeros((len(tables), total)), np.zeros((len(tables), total)), np.zeros((JOINTS, total))
    for n, (table, ring) in enumerate(zip(tables, rings, strict=True)):
        part = slice(start, start + len(table.omega))
        start = part.stop
        across = chord(0, NODES // 2 + int(off[n, 0]), ring).reshape(NODES, 3)[:, :2]
        coil[n, part] = np.einsum("na,nam->m", across, table.plane)
        heard[n, part] = table.normal[QUARTER + int(off[n, 1])]
        if n == 0:
            width = chord(QUARTER, 3 * QUARTER + int(off[n, 2]), ring).reshape(NODES, 3)[:, :2]
            joint[0, part] = np.einsum("na,nam->m", width, table.plane)
    return np.concatenate([coil, coil, joint]), heard[:sensors]


def _in_water(
    omega: np.ndarray, damping: np.ndarray, volume: np.ndarray, area: float, forces: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return A and B of modes, their velocities, and the sound field's state, which all volume that moves feels."""
    count = len(omega)
    pull, corner = radiation(area)
    dynamics = np.zeros((2 * count + 1, 2 * count + 1))
    dynamics[:count, count:-1] = np.eye(count)
    dynamics[count:-1, :count] = -np.diag(omega**2)
    dynamics[count:-1, count:-1] = -np.diag(2 * damping * omega) - pull * np.outer(volume, volume)
    dynamics[count:-1, -1] = pull * volume
    dynamics[-1, count:-1] = corner * volume
    dynamics[-1, -1] = -corner
    inlet = np.zeros((2 * count + 1, forces.shape[1]))
    inlet[count:-1] = forces
    return dynamics, inlet
