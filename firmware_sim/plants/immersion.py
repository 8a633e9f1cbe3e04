"""What the water around a vibrator does to its modes: it moves with them, and sound carries energy away."""

from dataclasses import replace

import numpy as np

from firmware_sim.plants.vibrator_modes import (
    SHELL_AREA,
    SHELL_MASS,
    Modes,
    flexural_modes,
    joined,
    lumped_modes,
)

DENSITY = {"air": 1.2, "water": 1000.0}
"""kg/m^3."""
SOUND_SPEED = {"air": 343.0, "water": 1500.0}
"""m/s."""
STEEL_DENSITY, STEEL_MODULUS, POISSON = 7850.0, 2.0e11, 0.3
"""kg/m^3, Pa and 1."""
END_CORRECTION = 0.6133
"""1, of the radius: the fluid that moves with a piston at the end of a long tube (Levine and Schwinger 1948)."""
WETTED_SHARE = 0.3
"""1, of a flexural mode's kinetic energy: the shells' wet faces; the rest is springs and what else stays dry."""

MEAN_SHAPE, MEAN_SQUARE_SHAPE = 1 / 2, 1 / 3
"""1: a shell held at its rim bulges as 1 - r^2 of its middle, where the accelerometer is; means over its face."""
FLUID_MASS = MEAN_SQUARE_SHAPE * END_CORRECTION * DENSITY["water"] * SHELL_AREA * float(np.sqrt(SHELL_AREA / np.pi))
"""kg of water that move with a shell, referred to its middle."""


def immersed_modes(rng: np.random.Generator) -> Modes:
    """Draw the same vibrator as `vibrator_modes`, in water."""
    return with_radiation(joined(lumped_modes(rng, FLUID_MASS), flexure_in_water(flexural_modes(rng))))


def flexure_in_water(dry: Modes) -> Modes:
    """Load the flexural modes of steel shells with the water on one side: lower, and smaller per force.

    The shell is a plate as heavy as it, `SHELL_MASS / SHELL_AREA`, and thick enough for that in steel; the water that
    moves with a bending wave of wavenumber k below coincidence weighs rho / k per area, on `WETTED_SHARE` of the mode.
    So the lower modes are pulled down most, and modes from above come into the band.

    Parameters
    ----------
    dry : Modes, flexural ones

    Returns
    -------
    Modes
        Mass-normalised again; the damping ratios stay, as those of a constant loss factor do.

    Source
    ------
    Fahy and Gardonio, Sound and Structural Vibration (2007), chapter 4 on fluid loading of plates; k from thin plate
    theory, D k^4 = omega^2 m.
    """
    area_mass = SHELL_MASS / SHELL_AREA
    rigidity = STEEL_MODULUS * (area_mass / STEEL_DENSITY) ** 3 / (12 * (1 - POISSON**2))
    wet = dry.frequency
    for _ in range(50):  # k belongs to the frequency in water, which k decides: a contraction
        wavenumber = ((2 * np.pi * wet) ** 2 * area_mass / rigidity) ** 0.25
        load = WETTED_SHARE * DENSITY["water"] / (wavenumber * area_mass)
        wet = dry.frequency / np.sqrt(1 + load)
    smaller = 1 / np.sqrt(1 + load)
    return replace(
        dry,
        frequency=wet,
        coil=dry.coil * smaller,
        spring=dry.spring * smaller,
        joint=dry.joint * smaller,
        shell=dry.shell * smaller,
    )


def with_radiation(modes: Modes) -> Modes:
    """Add to each mode's damping what its two shells radiate, as two pistons small against the wavelength.

    Parameters
    ----------
    modes : Modes

    Returns
    -------
    Modes
        With rho omega V^2 / (8 pi c) more damping, V m^3/sqrt(kg) being the volume that the mode displaces.

    Source
    ------
    Kinsler and others, Fundamentals of Acoustics (2000), simple source: radiation resistance rho c (k S)^2 / (4 pi),
    over 2 omega m.
    """
    volume = MEAN_SHAPE * SHELL_AREA * modes.shell.sum(axis=0)
    radiated = DENSITY["water"] * 2 * np.pi * modes.frequency * volume**2 / (8 * np.pi * SOUND_SPEED["water"])
    return replace(modes, damping=modes.damping + radiated)
