"""What a moving-coil vibrator does with a small drive, from its electrical and mechanical impedances."""

from dataclasses import dataclass

import numpy as np

from firmware_sim.plants.moving_coil import Motor, Moving, MovingCoil


@dataclass(frozen=True)
class SmallSignal:
    """Responses to the drive, each of shape (bins, units, units).

    Parameters
    ----------
    acceleration : complex array, shape (bins, units, units), m/s^2 per V
        Of the plates at their sensors.
    displacement : complex array, shape (bins, units, units), m/V
        Of the coils out of their gaps.
    current : complex array, shape (bins, units, units), A/V
    """

    acceleration: np.ndarray
    displacement: np.ndarray
    current: np.ndarray


def small_signal(vibrator: MovingCoil, frequency: np.ndarray) -> SmallSignal:
    """Return the responses of a cold vibrator whose seals slide without friction.

    Parameters
    ----------
    vibrator : MovingCoil
    frequency : array, shape (bins,), Hz
        Above 0.

    Source
    ------
    Beranek and Mellow, Acoustics (2012), chapter 6, for one coil: blocked electrical and motional impedance; here of
    several that share a housing and its gas.
    """
    motor, moving = vibrator.motor, vibrator.moving
    s = 2j * np.pi * frequency[:, None]
    given, heard = _receptances(moving, s)
    count = len(moving.mass)
    free = _diagonal(given) + np.outer(moving.facing, moving.facing) * _housing(moving, s)[:, :, None]
    back = np.eye(count) + (_diagonal(_suspension(moving, s)) + gas_stiffness(moving)) @ free
    force = np.linalg.solve(back, np.broadcast_to(np.diag(motor.factor), back.shape))
    displacement = free @ force
    induced = s[:, :, None] * motor.factor[:, None] * displacement
    current = motor.gain * np.linalg.inv(_diagonal(_blocked(motor, s)) + induced)
    acceleration = (s**2 * heard)[:, :, None] * (force @ current)
    return SmallSignal(acceleration, displacement @ current, current)


def linear_response(vibrator: MovingCoil, frequency: np.ndarray) -> np.ndarray:
    """Return G as the sensors say it, shape (bins, units, units), m/s^2 per V.

    Parameters
    ----------
    vibrator : MovingCoil
    frequency : array, shape (bins,), Hz
    """
    seen = vibrator.reception.sensors.response(frequency)
    whole: np.ndarray = seen[:, :, None] * small_signal(vibrator, frequency).acceleration
    return whole


def gas_stiffness(moving: Moving) -> np.ndarray:
    """Return what the gas adds to the stiffness of all units for small excursions, shape (units, units), N/m."""
    stiffness: np.ndarray = moving.ratio * moving.pressure / moving.volume * np.outer(moving.area, moving.area)
    return stiffness


def _receptances(moving: Moving, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return how far coil and sensor of each plate move in space per force at the coil, (bins, units) m/N."""
    omega = 2 * np.pi * moving.modes[:, :, 0]
    laplace = s[:, :, None]
    bent = moving.modes[:, :, 2] / (laplace**2 + 2 * moving.modes[:, :, 1] * omega * laplace + omega**2)
    rigid = 1 / s**2
    given = (rigid + (moving.modes[:, :, 2] * bent).sum(axis=2)) / moving.mass
    heard = (rigid + (moving.modes[:, :, 3] * bent).sum(axis=2)) / moving.mass
    return given, heard


def _housing(moving: Moving, s: np.ndarray) -> np.ndarray:
    housing: np.ndarray = 1 / (moving.mount + s * moving.loss + s**2 * moving.housing)
    return housing


def _suspension(moving: Moving, s: np.ndarray) -> np.ndarray:
    stiffness, rate = moving.creep[:, :, 0], moving.creep[:, :, 1]
    relaxed = moving.stiffness - stiffness.sum(axis=1)
    creeping = (stiffness * s[:, :, None] / (s[:, :, None] + rate)).sum(axis=2)
    whole: np.ndarray = relaxed + creeping + s * moving.damping
    return whole


def _blocked(motor: Motor, s: np.ndarray) -> np.ndarray:
    iron = s * motor.iron_inductance
    blocked: np.ndarray = (
        motor.resistance + s * motor.inductance + iron * motor.iron_resistance / (iron + motor.iron_resistance)
    )
    return blocked


def _diagonal(values: np.ndarray) -> np.ndarray:
    whole: np.ndarray = values[:, :, None] * np.eye(values.shape[1])
    return whole
