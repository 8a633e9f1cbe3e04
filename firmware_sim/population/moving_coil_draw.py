"""The family `moving-coil`: loudspeaker motors at large signals, in another tradition than the seeded families.

Nothing of its distortion is drawn as a level: what the reference excursion makes of motor, suspension, gas and seal is
what there is.  Written without a look at what controls it.
"""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from firmware_sim.plants.moving_coil import Heating, LargeSignal, MovingCoil, MovingCoilPlant
from firmware_sim.plants.moving_coil_response import linear_response, small_signal
from firmware_sim.plants.reception import silent_reception
from firmware_sim.plants.suspension_drift import Softening
from firmware_sim.population.draw import Quantity
from firmware_sim.population.machine import Machine, draw_level
from firmware_sim.population.mechanics import log_uniform
from firmware_sim.population.moving_coil_laws import draw_heating, draw_large, draw_softening
from firmware_sim.population.moving_coil_motion import UNITS, draw_motor, draw_moving, with_gas
from firmware_sim.population.references import RATE, SECONDS, Wanted, draw_references, drive_for, needed
from firmware_sim.population.sensing import draw_reception, draw_sensors
from firmware_sim.population.streams import Streams

FRACTION = (0.05, 0.6)
"""1: the excursion of the machine's own reference over x_max.  Below 0.05 a sound motor's distortion is some -90 dB;
beyond 0.6 peaks of what corrects it would be at x_max, and no one runs a projector there for hours."""
EXCURSION = (0.2e-3, 15e-3)
"""m, x_max: from inertial shakers to long-throw woofers and projectors [Klippel 2006 has 0.3 to 12 mm]."""
ATTEMPTS = 500
"""Levels drawn until x_max is within its range."""


@dataclass(frozen=True)
class Worked:
    """What a reference of 1 m/s^2 makes of a vibrator that is linear.

    Parameters
    ----------
    excursion, current, power : float, m, A and W
        The largest of all units; the power in copper is the mean over the reference.
    """

    excursion: float
    current: float
    power: float


def draw_moving_coil(family: str, seed: int) -> Machine:
    """Draw a vibrator of the family.

    Parameters
    ----------
    family : str
    seed : int, >= 0
    """
    streams = Streams(seed, "vibrator", family)
    units = 1 + int(streams("units").choice(len(UNITS), p=UNITS))
    moving, first = draw_moving(streams, units)
    sensors, sensing = draw_sensors(streams, units)
    references = draw_references(streams, first)
    motor, still = draw_motor(streams, moving), LargeSignal(offset=(0.0,) * units)
    small = MovingCoil(motor, moving, still, Heating(), Softening(), silent_reception(sensors))
    each = [worked(small, wanted) for wanted in references]
    sensitivity, level, excursion = _rating(streams, each[0])
    need = needed(partial(linear_response, small), references[0])
    gain = float(np.sqrt(2)) * need.rms / sensitivity
    filled, swept = with_gas(streams, moving, excursion)
    large, said = draw_large(streams, small, excursion, each[0].excursion * level, each[0].current * level, first)
    heating, warming = draw_heating(streams, each[0].power * level**2)
    softening, drifting = draw_softening(streams)
    reception, surrounding = draw_reception(streams, sensors, level, references[0].line)
    whole = MovingCoil(replace(motor, gain=gain), filled, large, heating, softening, reception)
    return Machine(
        partial(MovingCoilPlant, whole, seed=seed),
        partial(linear_response, whole),
        (units, units),
        _rings(whole, first),
        float(sensors.delay.max()),
        references,
        level,
        (
            *_said(whole, first, each[0].excursion * level),
            Quantity("gas swept at x_max", swept, "1"),
            *said,
            *warming,
            *drifting,
            *sensing,
            *surrounding,
        ),
        tuple(FRACTION[1] * excursion / wanted.excursion for wanted in each),
    )


def worked(vibrator: MovingCoil, wanted: Wanted) -> Worked:
    """Return what a reference of 1 m/s^2 makes of a vibrator that is linear.

    Parameters
    ----------
    vibrator : MovingCoil
    wanted : Wanted
    """
    spectrum = np.fft.rfft(drive_for(partial(linear_response, vibrator), wanted), axis=0)
    inside = np.flatnonzero(np.abs(spectrum).max(axis=1) > 1e-9 * np.abs(spectrum).max())
    inside = inside[inside > 0]
    samples = 2 * (len(spectrum) - 1)
    small = small_signal(vibrator, inside * RATE / samples)
    motions = []
    for response in (small.displacement, small.current):
        lines = np.zeros_like(spectrum)
        lines[inside] = np.einsum("bij,bj->bi", response, spectrum[inside])
        motions.append(np.fft.irfft(lines, samples, axis=0))
    excursion, current = motions
    loss = (current**2).sum(axis=0) / (RATE * SECONDS) * vibrator.motor.resistance
    return Worked(float(np.abs(excursion).max()), float(np.abs(current).max()), float(loss.max()))


def _rating(streams: Streams, each: Worked) -> tuple[float, float, float]:
    """Draw what drive the reference needs, V per m/s^2, its level, m/s^2, and x_max, m, which is within its range."""
    fraction = float(log_uniform(streams("excursion"), *FRACTION))
    for attempt in range(ATTEMPTS):
        sensitivity, level = draw_level(streams.within(f"rating {attempt}"))
        excursion = each.excursion * level / fraction
        if EXCURSION[0] <= excursion <= EXCURSION[1]:
            return sensitivity, level, excursion
    raise ValueError(f"none of {ATTEMPTS} levels of this seed needs an x_max that there is")


def _rings(vibrator: MovingCoil, first: float) -> float:
    """Return the time constant of the slowest decay, s: of the mounts, of a plate, or of a piston with open coils."""
    moving = vibrator.moving
    plates = 1 / (2 * np.pi * moving.modes[:, :, 0] * moving.modes[:, :, 1])
    pistons = 2 * moving.mass / moving.damping
    return max(2 * moving.housing / moving.loss, float(plates.max()), float(pistons.max()), 1 / first)


def _said(vibrator: MovingCoil, first: float, reached: float) -> tuple[Quantity, ...]:
    motor, moving, modes = vibrator.motor, vibrator.moving, vibrator.moving.modes
    mounted = float(np.sqrt(moving.mount / moving.housing) / (2 * np.pi))
    creeping = float((moving.creep[:, :, 0].sum(axis=1) / moving.stiffness).mean())
    return (
        Quantity("coils", len(moving.mass)),
        Quantity("sensors", len(moving.mass)),
        Quantity("modes", modes.shape[0] * (modes.shape[1] + 1) + 1),
        Quantity("first resonance", first, "Hz"),
        Quantity("last resonance", float(modes[:, :, 0].max()), "Hz"),
        Quantity("first break-up", float(modes[:, :, 0].min()), "Hz"),
        Quantity("mounts' resonance", mounted, "Hz"),
        Quantity("moving mass", float(moving.mass.mean()), "kg"),
        Quantity("gas", moving.volume, "m^3"),
        Quantity("stiffness that creeps", creeping, "1"),
        Quantity("facing", tuple(map(float, moving.facing)), "1"),
        Quantity("force factor", float(motor.factor.mean()), "N/A"),
        Quantity("resistance", float(motor.resistance.mean()), "ohm"),
        Quantity("inductance", 1e3 * float(motor.inductance.mean()), "mH"),
        Quantity("amplifier gain", motor.gain, "V/V"),
        Quantity("x_max", 1e3 * vibrator.large.excursion, "mm"),
        Quantity("excursion of the reference over x_max", reached / vibrator.large.excursion, "1"),
    )
