"""A rig whose plant is two impulse responses, and how to put faults into its card."""

from collections.abc import Callable
from typing import Any

import numpy as np

from firmware_sim.audio import SteppedStream
from firmware_sim.faults import Fault
from firmware_sim.plant_blocks import ImpulseResponse
from vibractl.config import Audio, RigConfig, Simulator

RATE = 44_100
ROUND_TRIP = 512 + 61


def rig(files: list[str], **audio: Any) -> RigConfig:
    return RigConfig(
        audio=Audio(**({"isolated": False} | audio)),
        simulator=Simulator(plant="impulse-response", options={"files": files}),
    )


def sweep(seconds: float = 0.4) -> np.ndarray:
    """Return two tones that start and end at rest."""
    time = np.arange(round(seconds * RATE)) / RATE
    tones = np.sin(2 * np.pi * np.array([40.0, 90.0]) * time[:, None])
    return 2.0 * tones * np.sin(np.pi * time / seconds)[:, None] ** 2


def expected(files: list[str], drive: np.ndarray) -> np.ndarray:
    plant = ImpulseResponse(files)
    plant.prepare(float(RATE), len(drive))
    response = np.empty_like(drive)
    plant.process(drive, response)
    return response


def later(stream: SteppedStream, blocks: int, kind: Callable[..., Fault], **what: Any) -> None:
    stream.card.faults.append(kind(block=stream.card.blocks + blocks, **what))
