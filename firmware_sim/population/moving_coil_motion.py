"""The motors and moving parts that the family `moving-coil` draws, for small excursions."""

from dataclasses import replace

import numpy as np

from firmware_sim.plants.moving_coil import Motor, Moving
from firmware_sim.plants.moving_coil_response import gas_stiffness
from firmware_sim.population.mechanics import log_uniform
from firmware_sim.population.streams import Streams

UNITS = (0.35, 0.45, 0.2)
"""1: of vibrators with one coil, with two, three."""
SCATTER = 0.03
"""1: standard deviation from unit to unit; loudspeakers of one type are sold as alike within 5 to 10 %."""
FIRST = (15.0, 40.0)
"""Hz, of the softest piston resonance with the housing held: those of woofers and of moving-coil projectors
[Sherman and Butler 2007]."""
MASS = (0.05, 10.0)
"""kg, of plate, coil and water: from a woofer's cone to a projector's piston."""
MECHANICAL_Q, ELECTRICAL_Q = (2.0, 12.0), (0.35, 3.0)
"""1, Q_ms and Q_es of one unit at its own resonance: Small, J. Audio Eng. Soc. 20 (1972) 798, and woofers' data sheets
since."""
RESISTANCE = (2.0, 8.0)
"""Ohm, R_e of coils of 4 to 8 ohm, and of two in parallel."""
CORNER, IRON_INDUCTANCE, IRON_CORNER = (200.0, 2000.0), (0.3, 2.0), (200.0, 2000.0)
"""Hz, R_e / (2 pi L_e); L_2 over L_e, and Hz, R_2 / (2 pi L_2): fits of the LR-2 model to woofers [Klippel 2006; Dodd,
Klippel and Oclee-Brown, AES 117th Convention (2004)], which have L_e and L_2 of 0.2 to 3 mH and R_2 of 1 to 10 ohm."""
CREEP, BRANCHES, FASTEST = (0.02, 0.2), 4, 3.0
"""1, the compliance gained in each decade of time [Knudsen and Jensen 1993 find about 0.1]; decades, of one branch
each; and the rate of the fastest, over the resonance."""
GAS = (0.3, 5.0)
"""1: the stiffness of the gas over that of a suspension, for one plate [Small 1972: closed boxes have 0.5 to 10]."""
LOADED, PRESSURE, AIR = (2.0, 200.0), (1.0e5, 2.0e6), 1.4
"""kg/m^2, what moves over its area: from a paper cone, 2, to a piston of 0.1 m in water, of which 85 are the water's
(8/3 rho a^3 / pi a^2) [Beranek and Mellow 2012, sec. 13.7]; Pa, of the gas, which is that of the water around: from the
surface to 190 m; and its ratio of heats."""
SWING = (3e-4, 0.1)
"""1: of the gas' volume, that all plates sweep at x_max: in less a box is as good as none, and for more a designer
would make it larger."""
ATTEMPTS = 1000
"""Plates and pressures drawn until it is."""
HOUSING, MOUNT, MOUNT_DAMPING = (6.0, 60.0), (2.0, 8.0), (0.02, 0.2)
"""1, over what moves; Hz and 1, of the housing alone on its mounts: rubber, well below the band."""
BREAK_UP, BREAK_UP_DAMPING = (120.0, 600.0), (0.003, 0.05)
"""Hz, of the first; and damping, from welded aluminium to doped paper."""
FREE_DISC = np.array([5.36, 9.00, 12.44, 20.47, 21.84])
"""1: omega a^2 sqrt(rho / D) of a free disc's modes, of Poisson's ratio 0.33: Leissa, Vibration of Plates (1969)."""
SYMMETRIC = np.array([False, True, False, False, False])
"""Those that are round, which a coil in the middle drives; the others hear of it because nothing is quite round."""
ROUND, UNROUND, SEEN = (0.3, 1.0), (0.03, 0.3), (0.2, 1.5)
"""1: shapes at the coil, and at the sensor, which is where there was room."""
INTO_LINE = 0.6
"""1: vibrators whose units all face the way that the housing goes; the others' face each other, or apart."""


def draw_moving(streams: Streams, units: int) -> tuple[Moving, float]:
    """Draw what moves, with plates of about 1 m^2 as yet, and the first resonance, Hz.

    Parameters
    ----------
    streams : Streams
    units : int
    """
    first = float(log_uniform(streams("first resonance"), *FIRST))
    rng = streams("moving")
    mass = float(log_uniform(rng, *MASS)) * _scattered(rng, units)
    stiffness = _scattered(rng, units)
    area, gas = _scattered(rng, units), float(log_uniform(streams("gas"), *GAS))
    softest = float(np.linalg.eigvals((np.diag(stiffness) + gas * np.outer(area, area)) / mass[:, None]).real.min())
    scale = (2 * np.pi * first) ** 2 / softest
    stiffness *= scale
    quality = float(log_uniform(streams("mechanical Q"), *MECHANICAL_Q))
    own = np.sqrt((stiffness + gas * scale * area**2) * mass)
    housing = float(log_uniform(streams("housing"), *HOUSING)) * float(mass.sum())
    rng = streams("mounts")
    omega, ratio = 2 * np.pi * float(log_uniform(rng, *MOUNT)), float(log_uniform(rng, *MOUNT_DAMPING))
    return Moving(
        mass,
        stiffness,
        own / quality * _scattered(rng, units),
        _creep(streams, stiffness, 2 * np.pi * first),
        area,
        _facing(streams, units),
        _break_up(streams, units),
        housing,
        omega**2 * housing,
        2 * ratio * omega * housing,
        PRESSURE[0],
        AIR * PRESSURE[0] / (gas * scale),
        AIR,
    ), first


def with_gas(streams: Streams, moving: Moving, excursion: float) -> tuple[Moving, float]:
    """Return it with gas as stiff, but areas and a pressure that there are, and what part of it is swept at x_max, 1.

    Parameters
    ----------
    streams : Streams
    moving : Moving
    excursion : float, m
        x_max.

    Raises
    ------
    ValueError : the plates sweep too much or too little of any gas.
    """
    stiffness, rng = gas_stiffness(moving)[0, 0], streams("gas around")
    for _ in range(ATTEMPTS):
        area = moving.area / moving.area[0] * moving.mass[0] / float(log_uniform(rng, *LOADED))
        pressure = float(log_uniform(rng, *PRESSURE))
        volume = AIR * pressure * float(area[0]) ** 2 / stiffness
        swept = excursion * float(area.sum()) / volume
        if SWING[0] <= swept <= SWING[1]:
            return replace(moving, area=area, volume=volume, pressure=pressure), swept
    raise ValueError(f"x_max of {excursion:.3g} m sweeps too much or little of any gas")


def draw_motor(streams: Streams, moving: Moving) -> Motor:
    """Draw the motors, behind an amplifier of gain 1.

    Parameters
    ----------
    streams : Streams
    moving : Moving
    """
    units = len(moving.mass)
    rng = streams("motor")
    resistance = float(log_uniform(rng, *RESISTANCE)) * _scattered(rng, units)
    quality = float(log_uniform(rng, *ELECTRICAL_Q))
    own = np.sqrt((moving.stiffness + np.diag(gas_stiffness(moving))) * moving.mass)
    factor = np.sqrt(own * resistance / quality) * _scattered(rng, units)
    rng = streams("inductance")
    inductance = resistance / (2 * np.pi * float(log_uniform(rng, *CORNER))) * _scattered(rng, units)
    iron = inductance * float(log_uniform(rng, *IRON_INDUCTANCE))
    iron_resistance = 2 * np.pi * float(log_uniform(rng, *IRON_CORNER)) * iron
    return Motor(1.0, factor, resistance, inductance, iron_resistance, iron)


def _scattered(rng: np.random.Generator, units: int) -> np.ndarray:
    scattered: np.ndarray = 1 + SCATTER * np.clip(rng.standard_normal(units), -2.5, 2.5)
    return scattered


def _creep(streams: Streams, stiffness: np.ndarray, omega: float) -> np.ndarray:
    """Return branches, shape (units, branches, 2), that let compliance grow by as much in each decade of time."""
    decade = float(log_uniform(streams("creep"), *CREEP))
    left = 1 / (1 + decade * np.arange(BRANCHES + 1))
    rate = FASTEST * omega * 10.0 ** -np.arange(BRANCHES)
    each = stiffness[:, None] * (left[:-1] - left[1:])
    return np.stack([each, np.broadcast_to(rate, each.shape)], axis=2)


def _facing(streams: Streams, units: int) -> np.ndarray:
    if streams("facing").uniform() < INTO_LINE:
        return np.ones(units)
    return np.where(np.arange(units) % 2 == 0, 1.0, -1.0)


def _break_up(streams: Streams, units: int) -> np.ndarray:
    """Return the modes of the plates, shape (units, modes, 4): free discs, not quite round."""
    rng = streams("break-up")
    lowest, count = float(log_uniform(rng, *BREAK_UP)), int(rng.integers(2, len(FREE_DISC) + 1))
    loss = float(log_uniform(rng, *BREAK_UP_DAMPING))
    shape = units, len(FREE_DISC)
    stretched = np.sort(FREE_DISC / FREE_DISC[0] * (1 + SCATTER * np.clip(rng.standard_normal(shape), -2.5, 2.5)), 1)
    stretched /= stretched[:, 0].min()  # the lowest is what was drawn
    damping = np.clip(loss * log_uniform(rng, 0.5, 2.0, units * shape[1]).reshape(shape), *BREAK_UP_DAMPING)
    size = rng.uniform(size=shape)
    low, high = np.where(SYMMETRIC, ROUND[0], UNROUND[0]), np.where(SYMMETRIC, ROUND[1], UNROUND[1])
    driven = low * (high / low) ** size * rng.choice([-1.0, 1.0], shape)
    heard = log_uniform(rng, *SEEN, units * shape[1]).reshape(shape) * rng.choice([-1.0, 1.0], shape)
    return np.stack([lowest * stretched, damping, driven, heard], axis=2)[:, :count]
