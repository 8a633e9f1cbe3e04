"""The family `lumped`: exciters of two masses each on one frame, with springs that surge and dashpots along them."""

import numpy as np

from firmware_sim.plants.structure import from_state_space
from firmware_sim.plants.two_mass_exciter import Lumped, Spring, Unit, first_order, two_mass_exciters, with_loss
from firmware_sim.population.draw import Quantity
from firmware_sim.population.mechanics import MOST, Mechanics, log_uniform, lowest_modes
from firmware_sim.population.streams import Streams

REACTION, PLATE, FRAME = (10.0, 200.0), (0.5, 4.0), (1.0, 20.0)
"""kg; times that; times all plates."""
DASHPOTS, LOSS = (0.001, 0.04), (0.002, 0.01)
"""1, damping ratios: of the dashpots as if the reaction mass were alone, and of the springs themselves."""
SPRING_MASS = (0.03, 0.2)
"""Of the reaction mass."""
JOINTS = 1


def draw_two_masses(streams: Streams, coils: int, sensors: int, first: float, modes: int) -> Mechanics:
    """Draw exciters on a frame.

    Parameters
    ----------
    streams : Streams
    coils, sensors : int
    first : float, Hz
        The first resonance.
    modes : int
        About so many: a spring's mass is as many points as are wanted.

    Returns
    -------
    Mechanics
    """
    whole, reactions, plates, said = _exciters(streams, coils, first, _lumps(coils, modes))
    masses, stiffness, dashpots = whole.matrices()
    damping = with_loss(masses, stiffness, dashpots, float(log_uniform(streams("loss"), *LOSS)))
    bodies = len(masses)
    stretch, joint, heard = np.zeros((coils, bodies)), np.zeros((JOINTS, bodies)), np.zeros((sensors, bodies))
    stretch[np.arange(coils), reactions], stretch[np.arange(coils), plates] = 1.0, -1.0
    joint[:, plates[0]], joint[:, 0] = 1.0, -1.0
    heard[np.arange(sensors), plates[:sensors]] = 1.0
    forces = np.concatenate([stretch, stretch, joint])
    structure = from_state_space(
        first_order(masses, stiffness, damping),
        np.concatenate([np.zeros((bodies, len(forces))), (forces / masses).T]),
        np.concatenate([forces, np.zeros_like(forces)], axis=1),
        np.concatenate([heard, np.zeros_like(heard)], axis=1),
    )
    factor = first / float(structure.frequency.min())
    moved = structure.moved(np.full(len(structure.poles), factor))
    return Mechanics(lowest_modes(moved, MOST), coils, JOINTS, said)


def _exciters(
    streams: Streams, coils: int, first: float, lumps: list[int]
) -> tuple[Lumped, list[int], list[int], tuple[Quantity, ...]]:
    """Draw masses, springs and dashpots; all units are alike but for a few per cent."""
    reaction = float(log_uniform(streams("reaction mass"), *REACTION))
    plate = reaction * float(log_uniform(streams("plate mass"), *PLATE))
    frame = plate * coils * float(log_uniform(streams("frame mass"), *FRAME))
    dashpots = float(log_uniform(streams("dashpots"), *DASHPOTS))
    rng, pace = streams("springs"), 2 * np.pi * first
    stiff, under = reaction * (pace * rng.uniform(1.0, 2.0)) ** 2, plate * (pace * rng.uniform(1.5, 5.0)) ** 2
    rng = streams("units")

    def spring(stiffness: float, mass: float, count: int) -> Spring:
        here = stiffness * (1 + 0.06 * rng.standard_normal())
        damped = 2 * dashpots * log_uniform(rng, 0.5, 1.5) * np.sqrt(stiffness * reaction)
        return Spring(here, float(damped), mass * float(log_uniform(rng, *SPRING_MASS)), count)

    units = [
        Unit(
            reaction * (1 + 0.05 * rng.standard_normal()),
            plate * (1 + 0.05 * rng.standard_normal()),
            spring(stiff, reaction, lumps[2 * c]),
            spring(under, reaction, lumps[2 * c + 1]),
        )
        for c in range(coils)
    ]
    ties = [spring(under * rng.uniform(0.01, 0.2), 0.0, 0) for _ in range(coils - 1)]
    suspension = spring((frame + coils * plate) * (pace * rng.uniform(1.0, 2.0)) ** 2, 0.0, 0)
    said = (
        Quantity("reaction masses", tuple(unit.reaction for unit in units), "kg"),
        Quantity("plate masses", tuple(unit.plate for unit in units), "kg"),
        Quantity("frame mass", frame, "kg"),
        Quantity("surge modes", sum(lumps)),
    )
    return *two_mass_exciters(units, frame, suspension, ties), said


def _lumps(coils: int, modes: int) -> list[int]:
    """Share out the points that springs are made of, so that there are `modes` in all."""
    wanted = max(modes - 2 * coils - 1, 2 * coils)
    return [wanted // (2 * coils) + (n < wanted % (2 * coils)) for n in range(2 * coils)]
