"""The truth about a linear simulated vibrator: its response from its modes, exactly discretized, by matrices."""

from collections.abc import Callable

import numpy as np
from scipy.linalg import expm

from firmware_sim.plants import vibrator
from firmware_sim.plants.vibrator import RETUNE_EVERY, VibratorPlant
from firmware_sim.plants.vibrator_modes import vibrator_modes

RATE = 44_100.0
ABOUT = {"rig": "simulated-vibrator", "date": "2026-01-02T03:04:05+00:00"}
"""Words of a model."""
LINEAR = {"nonlinearity": 0.0, "drift": 0.0, "hum": -400.0}


def linear_response(seed: int, frequency: np.ndarray) -> np.ndarray:
    """Return the response (bins, 2, 2), m/s^2 per V, of the plant without friction, stiffening and drift.

    Every mode is a second-order system under a force held over a sample; the coil is a first-order lag, with the
    back-EMF behind it; the acceleration is read at the start of the sample.
    """
    modes = vibrator_modes(np.random.default_rng(seed))
    omega = 2 * np.pi * modes.frequency
    lag = np.exp(-2 * np.pi * vibrator.COIL_CORNER / RATE)
    response = np.zeros((len(frequency), 2, 2), complex)
    held = [_held(w, 2 * ratio * w) for w, ratio in zip(omega, modes.damping, strict=True)]
    for n, f in enumerate(frequency):
        z = np.exp(2j * np.pi * f / RATE)
        motion = np.array([np.linalg.solve(z * np.eye(2) - step, force) for step, force in held])  # q, v per force
        damping = 2 * modes.damping * omega
        flexing = omega**2 * motion[:, 0] + damping * motion[:, 1]
        acceleration = modes.shell @ ((1 - flexing)[:, None] * modes.coil.T)
        velocity = modes.coil @ (motion[:, 1:] * modes.coil.T)
        follow = (1 - lag) / (z - lag)
        loop = np.eye(2) + follow * vibrator.BACK_EMF * vibrator.FORCE_FACTOR**2 * velocity
        response[n] = acceleration @ np.linalg.solve(loop, vibrator.FORCE_FACTOR * follow * np.eye(2))
    return response


def emitter(seed: int, silence: int = 0, **options: float) -> Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]:
    """Return an `Emit` that drives a plant directly; `silence` makes the noise another one."""
    plant = VibratorPlant(RATE, seed=seed, **options)
    rest = np.zeros((RETUNE_EVERY, 2))
    for _ in range(silence):
        plant.run(rest, np.zeros_like(rest))

    def emit(drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        emitted = drive.astype(np.float32)
        response = np.zeros(drive.shape)
        plant.run(emitted.astype(float), response)
        return emitted, response.astype(np.float32)

    return emit


def _held(omega: float, damping: float) -> tuple[np.ndarray, np.ndarray]:
    system = np.array([[0.0, 1.0, 0.0], [-(omega**2), -damping, 1.0], [0.0, 0.0, 0.0]])
    exact = expm(system / RATE)
    return exact[:2, :2], exact[:2, 2]
