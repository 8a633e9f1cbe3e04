"""The family `shell`: coils shake free cylinders of random geometry, each through a mass of its own on a spring."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from firmware_sim.plants.free_shell import MOST_WAVES, Cylinder, ShellModes, coupled_modes, shell_modes
from firmware_sim.plants.structure import from_modes
from firmware_sim.population.draw import Quantity
from firmware_sim.population.mechanics import Mechanics, log_uniform, lowest_modes, modal_damping
from firmware_sim.population.streams import Streams

MATERIALS = {"steel": (7850.0, 2.1e11, 0.3), "aluminium": (2700.0, 7.0e10, 0.33), "bronze": (8800.0, 1.1e11, 0.34)}
"""kg/m^3, Pa and 1."""
FLEXURE, HIGHEST_FLEXURE = (1.3, 6.0), 150.0
"""The shell's first flexural mode over the first resonance, and Hz at most."""
RADIUS, SLIMNESS, LENGTH = (0.15, 0.8), (0.005, 0.1), (1.0, 6.0)
"""m, thickness over radius, and length over radius."""
ON_EACH = 1
"""Coils on a cylinder, at most; where there are more cylinders stand end to end, bolted rim to rim."""
KEPT = 64
"""Modes of a cylinder alone, the lowest."""
MOUNTS, BOLTS, JOINTS = 8, 6, 2
BESIDE, ACROSS = 0.03, 0.1
"""Of the length, and of a turn: from a coil to its sensor, and across a joint within a cylinder, at most."""


@dataclass(frozen=True)
class _Body:
    """A cylinder with what is on it: how its modes move under coils and sensors, at mounts, rims and across joints."""

    omega: np.ndarray
    coils: np.ndarray
    sensors: np.ndarray
    mounts: np.ndarray
    rims: tuple[np.ndarray, np.ndarray]
    joints: np.ndarray


def draw_shell(streams: Streams, coils: int, sensors: int, first: float, modes: int) -> Mechanics:
    """Draw cylinders.

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
    shell = _cylinder(streams, MATERIALS[material], first)
    carried = [min(ON_EACH, coils - start) for start in range(0, coils, ON_EACH)]
    bodies = [_body(streams.within(f"cylinder {n}"), shell, count) for n, count in enumerate(carried)]
    under, heard = (block_diag(*(getattr(body, name) for body in bodies)) for name in ("coils", "sensors"))
    masses = shell.mass * streams("masses").uniform(0.05, 0.3, coils) / ON_EACH
    springs = masses * (2 * np.pi * first * streams("springs").uniform(1.0, 2.0, coils)) ** 2
    rims = _rims(bodies)
    mount = shell.mass / MOUNTS * (2 * np.pi * first * streams("mounts").uniform(1.0, 2.5)) ** 2
    bolt = shell.mass / BOLTS * (2 * np.pi * first * float(log_uniform(streams("bolts"), 1.0, 10.0))) ** 2
    held = np.concatenate([block_diag(*(body.mounts for body in bodies)), rims])
    tie = np.repeat([mount, bolt], [MOUNTS * len(bodies), len(rims)])
    omega = np.concatenate([body.omega for body in bodies])
    moved, shapes = coupled_modes(omega, under, masses, springs, held, tie)
    on_shell = shapes[: len(omega)]
    stretch = shapes[len(omega) :] - under @ on_shell
    joints = rims[:JOINTS] if len(rims) else bodies[0].joints
    loss = float(log_uniform(streams("loss"), 0.002, 0.04))
    structure = from_modes(
        moved / (2 * np.pi),
        modal_damping(streams("damping"), loss, len(moved)),
        np.concatenate([stretch, stretch, joints @ on_shell]),
        heard[:sensors] @ on_shell,
    )
    factor = first / float(structure.frequency.min())
    said = (
        Quantity("material", material),
        Quantity("cylinders", len(bodies)),
        Quantity("radius", shell.radius / factor, "m"),
        Quantity("length", shell.length / factor, "m"),
        Quantity("thickness", shell.thickness / factor, "m"),
        Quantity("cylinder mass", shell.mass / factor**3, "kg"),
        Quantity("coil masses", tuple(float(mass) for mass in masses / factor**3), "kg"),
    )
    return Mechanics(lowest_modes(structure.resized(factor), modes), coils, JOINTS, said)


def _cylinder(streams: Streams, material: tuple[float, float, float], first: float) -> Cylinder:
    """Draw a geometry whose first flexural mode alone, two waves, is as far above the first resonance as is drawn."""
    density, modulus, poisson = material
    lowest = FLEXURE[0] * first
    highest = max(min(FLEXURE[1] * first, HIGHEST_FLEXURE), 1.2 * lowest)
    flexure = float(log_uniform(streams("flexure"), lowest, highest))
    speed = np.sqrt(modulus / (density * (1 - poisson**2)))
    slim = float(2 * np.pi * flexure / (speed * np.sqrt(9 / (12 * 1.25))))  # thickness / radius^2, from Rayleigh's
    low, high = max(RADIUS[0], SLIMNESS[0] / slim), min(RADIUS[1], SLIMNESS[1] / slim)
    radius = float(log_uniform(streams("radius"), low, max(high, low)))
    length = radius * float(log_uniform(streams("length"), *LENGTH))
    return Cylinder(radius, length, slim * radius**2, density, modulus, poisson)


def _body(streams: Streams, shell: Cylinder, coils: int) -> _Body:
    """Draw where imperfections turn the modes of a cylinder, and where coils, sensors and the rest are on it."""
    rng = streams("imperfections")
    table = shell_modes(shell, rng.uniform(0, 2 * np.pi, MOST_WAVES))
    table = table.with_omega(table.omega * (1 + rng.uniform(-0.015, 0.015, len(table.omega)))).lowest(KEPT)
    rng = streams("coil places")
    angle = 2 * np.pi * (np.arange(coils) + rng.uniform(-0.3, 0.3, coils)) / coils
    place = rng.uniform(-0.45, 0.45, coils)
    rng = streams("sensor places")
    beside = angle + 2 * np.pi * rng.uniform(-BESIDE, BESIDE, coils)
    along = np.clip(place + rng.uniform(-BESIDE, BESIDE, coils), -0.5, 0.5)
    return _Body(
        table.omega,
        table.radial(angle, place),
        table.radial(beside, along),
        table.radial(*_mounts(streams("mount places"))),
        (_rim(table, -0.5), _rim(table, 0.5)),
        _joints(streams("joint places"), table),
    )


def _mounts(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Draw where the shell hangs: all around either end, not quite evenly."""
    each = MOUNTS // 2
    angle = 2 * np.pi * (np.arange(MOUNTS) % each + rng.uniform(-0.2, 0.2, MOUNTS)) / each
    return angle, np.repeat([-0.5, 0.5], each)


def _rim(table: ShellModes, end: float) -> np.ndarray:
    return table.radial(2 * np.pi * np.arange(BOLTS) / BOLTS, np.full(BOLTS, end))


def _joints(rng: np.random.Generator, table: ShellModes) -> np.ndarray:
    """Draw joints within a cylinder: two points near each other."""
    angle, place = rng.uniform(0, 2 * np.pi, JOINTS), rng.uniform(-0.5, 0.5 - ACROSS, JOINTS)
    other = angle + 2 * np.pi * rng.uniform(-ACROSS, ACROSS, JOINTS)
    across: np.ndarray = table.radial(angle, place) - table.radial(other, place + ACROSS)
    return across


def _rims(bodies: list[_Body]) -> np.ndarray:
    """Return how the modes of all cylinders stretch the bolts between neighbours, shape (bolts, modes)."""
    count = [len(body.omega) for body in bodies]
    start = np.cumsum([0, *count])
    rows = np.zeros((BOLTS * (len(bodies) - 1), start[-1]))
    for n in range(len(bodies) - 1):
        here = slice(BOLTS * n, BOLTS * (n + 1))
        rows[here, start[n] : start[n + 1]] = bodies[n].rims[1]
        rows[here, start[n + 1] : start[n + 2]] = -bodies[n + 1].rims[0]
    return rows
