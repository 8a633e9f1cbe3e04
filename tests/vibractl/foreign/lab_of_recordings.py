"""Drives and responses of a linear vibrator, as files that other software may have made."""

import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import soundfile

from firmware_sim.plants.vibrator import VibratorPlant
from rigkit import config as rig_file
from tests.vibractl.foreign.lab_of_files import LabOfFiles
from tests.vibractl.linear_rig import QUIET, RATE, linear_config, linear_matrix
from vibractl.foreign.near import moved
from vibractl.setup import setup

NOISE = 1e-3
"""m/s^2, rms, in each response."""
VOLTS, ACCELERATION = 10.0, 400.0
"""What the number 1 is in sounds of the rig."""


@cache
def recorded_shots(count: int = 2) -> tuple[tuple[np.ndarray, np.ndarray], ...]:
    """Return drives, V, and responses, m/s^2, of shots of 70560 samples: the model's inverse, but at other levels."""
    learner = setup(linear_config(), linear_matrix()).learner()
    rng, plant, found = np.random.default_rng(3), VibratorPlant(RATE, **QUIET), []
    for shot in range(count):
        drive = np.array(learner.drive, dtype=np.float32).astype(float) * np.array([1.0, 0.97 - 0.05 * shot])
        response = np.zeros_like(drive)
        plant.run(drive, response)
        found.append((drive, response + NOISE * rng.standard_normal(response.shape)))
    return tuple(found)


def late(response: np.ndarray, delay: float, drift: float = 0.0) -> np.ndarray:
    """Return a signal as a recorder hears it that comes late, by another clock; the delay is that of its middle."""
    middle = (len(response) - 1) / 2
    return moved(response, (np.arange(len(response)) - delay - middle) / (1 + 1e-6 * drift) + middle)


class LabOfRecordings(LabOfFiles):
    """A folder with recordings `d0.wav`, `r0.wav`, `d1.wav` ... of one rig.

    Parameters
    ----------
    path : Path
    monkeypatch, capsys
        pytest's.
    """

    def __init__(self, path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
        super().__init__(path, monkeypatch, capsys)
        self.config = linear_config()
        (path / "rig.toml").write_text(rig_file.dump(self.config))
        for number, (drive, response) in enumerate(recorded_shots()):
            self.sound(f"d{number}.wav", drive / VOLTS)
            self.sound(f"r{number}.wav", response / ACCELERATION)

    def sound(self, name: str, data: np.ndarray, kind: str = "DOUBLE", form: str | None = None) -> str:
        """Write a sound, and return its name."""
        soundfile.write(self.path / name, data, RATE, kind, format=form)
        return name

    def words(self, drive: str, response: str, *more: str) -> tuple[str, ...]:
        """Return the words of an import."""
        return "vibractl", "import", "--config", "rig.toml", "--drive", drive, "--response", response, *more

    def shown(self, drive: str, response: str, *more: str) -> list[Mapping[str, Any]]:
        """Return what is found, shot by shot, without anything being written."""
        before = sorted(self.path.rglob("*"))
        self.done(*self.words(drive, response, "--dry-run", "--json", "found.json", *more))
        file = self.path / "found.json"
        found: list[Mapping[str, Any]] = json.loads(file.read_text())["found"]
        file.unlink()
        assert sorted(self.path.rglob("*")) == before
        return found

    def imported(self, drive: str, response: str, *more: str) -> Mapping[str, Any]:
        """Import into RUN, and return its summary."""
        self.done(*self.words(drive, response, "--out", "RUN", *more))
        figures: Mapping[str, Any] = json.loads((self.path / "RUN" / "summary.json").read_text())
        return figures

    def import_refused(self, drive: str, response: str, *more: str) -> str:
        """Return why an import is refused; nothing is written, not even a folder."""
        before = sorted(self.path.rglob("*"))
        said = self.refused(*self.words(drive, response, "--out", "RUN", *more))
        assert sorted(self.path.rglob("*")) == before
        return said
