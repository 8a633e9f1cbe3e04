"""A rig of two sides without dynamics, whose wiring and card can be put out of order, for the doctor."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import soundfile

from firmware_sim.audio import SteppedStream, Stream
from firmware_sim.laboratory import Laboratory
from rigkit.verdict import Verdict
from tests.vibractl.audio_rig import RATE
from vibractl.config import Audio, RigConfig, Simulator
from vibractl.doctor.examination import Examination, examine
from vibractl.transfer_matrix import TransferMatrix

SIDES = np.array([[10.0, 1.0], [1.0, 8.0]])
"""m/s^2 per V, from coils to accelerometers, at every frequency."""


def wired(folder: Path, sides: np.ndarray = SIDES, **audio: Any) -> RigConfig:
    """Return a rig whose response, shape (accelerometers, coils), is m/s^2 per V."""
    files = []
    for coil, column in enumerate(sides.T):
        files.append(str(folder / f"coil-{coil}.wav"))
        soundfile.write(files[-1], column[None], RATE, subtype="FLOAT")
    return RigConfig(
        audio=Audio(**({"isolated": False} | audio)),
        simulator=Simulator(plant="impulse-response", options={"files": files}),
    )


def measured(sides: np.ndarray = SIDES) -> TransferMatrix:
    """Return the model of such a rig as it was."""
    frequency = np.arange(10.0, 700.0)
    response = np.broadcast_to(sides + 0j, (len(frequency), *sides.shape)).copy()
    return TransferMatrix(frequency, response, np.full(response.shape, 1e-6), np.ones(response.shape))


def vibrating(**options: float) -> RigConfig:
    """Return a rig with the simulated vibrator."""
    return RigConfig(audio=Audio(isolated=False), simulator=Simulator(options=options))


def verdict(found: Examination, check: str) -> Verdict:
    (one,) = [each for each in found.verdicts if each.check == check]
    return one


def grades(config: RigConfig) -> dict[str, str]:
    return {each.check: each.grade for each in examine(config).verdicts}


def spoil(monkeypatch: pytest.MonkeyPatch, change: Callable[[np.ndarray, np.ndarray], None]) -> None:
    """Let `change(played, recorded)`, each (frames, channels), have its way with every block of a simulated card."""
    step = Laboratory.step

    def spoiled(self: Laboratory, played: np.ndarray, recorded: np.ndarray) -> None:
        step(self, played, recorded)
        change(played, recorded)

    monkeypatch.setattr(Laboratory, "step", spoiled)


def with_faults(monkeypatch: pytest.MonkeyPatch, put: Callable[[SteppedStream], None]) -> None:
    """Let `put` have its way with the card of every stream before it starts."""
    start = Stream.start

    def faulty(self: Stream) -> None:
        put(self)  # type: ignore[arg-type]
        start(self)

    monkeypatch.setattr(Stream, "start", faulty)
