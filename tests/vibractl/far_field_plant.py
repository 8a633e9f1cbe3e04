"""A vibrator in water before hydrophones, and its model and far field known exactly: for runs that judge there."""

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from firmware_sim.plants.vibrator_array import VibratorArrayPlant
from rigkit import config as rig_file
from vibractl.config import RigConfig
from vibractl.far_field import FarField, delayed
from vibractl.model_file import write_model
from vibractl.transfer_matrix import TransferMatrix

RATE, SECONDS = 44_100, 2
STEADY = {"drift": 0.0, "nonlinearity": 0.3, "noise": -80.0, "hum": -200.0}
LINEAR = {"nonlinearity": 0.0, "noise": -200.0, "far_field_noise": -200.0}


def far_config(hydrophones: int, *overrides: str, **options: Any) -> RigConfig:
    """Return the settings of a short far-field run, with more laid over them."""
    channels = list(range(4, 4 + hydrophones))
    plant = {"vibrators": 1, "hydrophones": hydrophones, "medium": "water", **STEADY, **options}
    texts = [f"simulator.options.{key}={value}" for key, value in plant.items()]
    return rig_file.load(
        None,
        RigConfig,
        (
            "audio.isolated=false",
            f"audio.far_field_channels={channels}",
            "reference.signal=chirp:30:75:2",
            "simulator.plant=vibrator-array",
            "quality.where=far-field",
            *texts,
            *overrides,
        ),
    )


@cache
def far_model(hydrophones: int, distance: float = 10.0) -> tuple[TransferMatrix, FarField]:
    """Return the linear plant's own small-signal model, from its impulse responses."""
    frames, lines = SECONDS * RATE, np.arange(14 * SECONDS, 652 * SECONDS + 1)
    near, far = np.zeros((len(lines), 2, 2), complex), np.zeros((len(lines), hydrophones, 2), complex)
    for coil in range(2):
        options = {**STEADY, **LINEAR, "distance": distance}
        plant = VibratorArrayPlant(RATE, vibrators=1, hydrophones=hydrophones, medium="water", **options)
        drive, response, pressure = np.zeros((frames, 2)), np.zeros((frames, 2)), np.zeros((frames, hydrophones))
        drive[0, coil] = 1.0
        plant.run(drive, response, pressure)
        near[:, :, coil], far[:, :, coil] = (np.fft.rfft(heard, axis=0)[lines] for heard in (response, pressure))
    transfer, frequency = far @ np.linalg.inv(near), lines / SECONDS
    about = {"rig": "simulated-vibrator"}
    matrix = TransferMatrix(frequency, near, 1e-4 * np.abs(near) ** 2, np.ones(near.shape), about)
    size, delay = np.ones(transfer.shape), np.full(hydrophones, (distance - 0.5) / 1500.0)
    return matrix, delayed(frequency, transfer, 1e-6 * np.abs(transfer) ** 2, size, delay)


def far_model_file(folder: Path, hydrophones: int) -> Path:
    """Write that model and return its path."""
    write_model(folder / "model.h5", *far_model(hydrophones))
    return folder / "model.h5"
