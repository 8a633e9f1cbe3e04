"""Runs of the simulated stage that several tests look at."""

import numpy as np

from firmware_sim.plants.piezo_stage import PiezoStagePlant

RATE = 10_000.0
X, Y, Z = range(3)


def run(
    plant: PiezoStagePlant, voltage: np.ndarray, force: np.ndarray | None = None, base: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return extension, position and laser, shape (samples, 3), m, for inputs of that shape; None is zero."""
    rest = np.zeros_like(voltage)
    extension, position, absolute = (np.zeros_like(voltage) for _ in range(3))
    plant.run(voltage, rest if force is None else force, rest if base is None else base, extension, position, absolute)
    return extension, position, absolute


def sweep(frequency: float, low: float, high: float, seconds: float) -> np.ndarray:
    """Return a voltage on all axes from `low` to `high` and back, raised cosine, shape (samples, 3), V."""
    time = np.arange(round(seconds * RATE)) / RATE
    wave = low + (high - low) * 0.5 * (1 - np.cos(2 * np.pi * frequency * time))
    return np.repeat(wave[:, None], 3, axis=1)


def opening(extension: np.ndarray, frequency: float) -> np.ndarray:
    """Return the widest opening of a sweep's last loop over its span, per axis, without what creeps in the meantime."""
    samples = round(RATE / frequency)
    period = extension[-samples - 1 :].copy()
    period -= np.linspace(0, 1, len(period))[:, None] * (period[-1] - period[0])
    widest: np.ndarray = np.max(period[::-1] - period, axis=0) / np.ptp(period, axis=0)
    return widest
