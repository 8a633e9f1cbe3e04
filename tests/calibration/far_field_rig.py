"""A vibrator array with hydrophones, driven directly, and the truth about its far field."""

from collections.abc import Callable

import numpy as np

from firmware_sim.plants.vibrator_array import VibratorArrayPlant
from rigkit import config as rig_file
from vibractl.config import RigConfig

RATE = 44_100
SHORT = ("band=[100, 160]", "records=4", "period=2", "run_in=0.3")
Emitter = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


def array_config(vibrators: int, hydrophones: int, *settings: str) -> RigConfig:
    """Return the settings of a card with a channel for each sensor; `settings` are of the characterisation."""
    sides = 2 * vibrators
    channels, far = list(range(1, sides + 1)), list(range(sides + 2, sides + 2 + hydrophones))
    audio = {
        "drive_channels": channels,
        "response_channels": channels,
        "loopback_output": sides + 1,
        "loopback_input": sides + 1,
        "far_field_channels": far,
    }
    texts = [f"audio.{key}={value}" for key, value in audio.items()]
    return rig_file.load(None, RigConfig, [*texts, *(f"characterisation.{text}" for text in settings)])


def array_emitter(plant: VibratorArrayPlant) -> Emitter:
    """Return an `Emit` that drives a plant directly."""

    def emit(drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        emitted = drive.astype(np.float32)
        response = np.zeros((len(drive), 2 * plant.vibrators))
        far_field = np.zeros((len(drive), plant.hydrophones))
        plant.run(emitted.astype(float), response, far_field)
        return emitted, np.hstack([response, far_field]).astype(np.float32)

    return emit


def true_transfer(plant: VibratorArrayPlant, frequency: np.ndarray) -> np.ndarray:
    """Return T by geometry, (bins, hydrophones, shells), Pa per m/s^2: rho S / (8 pi r), late by whole samples."""
    row = plant.spacing * (np.arange(plant.vibrators) - (plant.vibrators - 1) / 2)
    shells = np.array([(x, y) for y in row for x in (-0.5, 0.5)])
    angle = np.pi / 2 * np.arange(plant.hydrophones) / plant.hydrophones
    places = plant.distance * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    apart = np.linalg.norm(places[:, None] - shells, axis=-1)
    density, speed = {"air": (1.2, 343.0), "water": (1000.0, 1500.0)}[plant.medium]
    late = np.rint(apart / speed * RATE) / RATE
    return np.asarray(density * 0.3 / (8 * np.pi * apart) * np.exp(-2j * np.pi * frequency[:, None, None] * late))
