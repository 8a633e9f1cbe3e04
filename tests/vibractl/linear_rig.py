"""A rig whose plant is linear and known exactly: for tests that need learning to work, fast."""

from functools import cache
from pathlib import Path

import numpy as np

from firmware_sim.plants.vibrator import VibratorPlant
from rigkit import config as rig_file
from vibractl.config import RigConfig
from vibractl.model_file import write_model
from vibractl.transfer_matrix import TransferMatrix

RATE = 44_100
QUIET = {"nonlinearity": 0.0, "drift": 0.0, "noise": -200.0, "hum": -200.0}
SETTINGS = (
    "audio.isolated=false",
    "reference.signal=chirp:40:90:1",
    "learning.law=thesis",
    "learning.start=inverse",
    "learning.gains=[0.5]",
    "session.shots=4",
    *(f"simulator.options.{name}={value}" for name, value in QUIET.items()),
)


def linear_config(*overrides: str) -> RigConfig:
    """Return the settings of the linear rig, with more laid over them."""
    return rig_file.load(None, RigConfig, (*SETTINGS, *overrides))


@cache
def linear_matrix(seconds: int = 4) -> TransferMatrix:
    """Return the linear plant's transfer matrix from its impulse responses, every 1/seconds Hz from 15 to 650 Hz."""
    frames = seconds * RATE
    lines = np.arange(14 * seconds, 652 * seconds + 1)
    response = np.zeros((len(lines), 2, 2), complex)
    for coil in range(2):
        plant = VibratorPlant(RATE, **QUIET)
        drive, out = np.zeros((frames, 2)), np.zeros((frames, 2))
        drive[0, coil] = 1.0
        plant.run(drive, out)
        response[:, :, coil] = np.fft.rfft(out, axis=0)[lines]
    size = np.ones(response.shape)
    return TransferMatrix(lines / seconds, response, 1e-6 * np.abs(response) ** 2, size, {"rig": "simulated-vibrator"})


def linear_model(folder: Path) -> Path:
    """Write that matrix as a model file and return its path."""
    path = folder / "model.h5"
    write_model(path, linear_matrix())
    return path
