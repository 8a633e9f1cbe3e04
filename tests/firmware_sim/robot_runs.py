"""Runs of the simulated robot that several tests share."""

import numpy as np

from firmware_sim.plants.robot import RobotPlant


def run(plant: RobotPlant, reference: np.ndarray, wrench: np.ndarray | None = None) -> tuple[np.ndarray, ...]:
    """Return motor angle, torque, link angle and pose."""
    outputs = *(np.full((len(reference), 6), np.nan) for _ in range(3)), np.full((len(reference), 7), np.nan)
    plant.run(reference, np.zeros((len(reference), 6)) if wrench is None else wrench, *outputs)
    return outputs


def held(plant: RobotPlant, wrench: np.ndarray, seconds: float = 3.0) -> tuple[np.ndarray, ...]:
    """Return what a constant wrench makes of an arm that stands still."""
    frames = round(seconds * plant.rate)
    return run(plant, np.tile(plant.home, (frames, 1)), np.tile(wrench, (frames, 1)))
