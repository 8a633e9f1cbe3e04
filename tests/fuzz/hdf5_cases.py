"""Damaged HDF5 files: models of the vibrator, the stage and its hysteresis, learned drives, other programs' records."""

import random
import tempfile
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ctlblocks.recording import Recording, RecordingError
from rigkit.foreign_record import read_channels
from rigkit.model_file import ModelFileError
from stagectl.models import model_file as stage_file
from stagectl.stage.hysteresis import HysteresisModel
from stagectl.stage.hysteresis_file import read_hysteresis, write_hysteresis
from tests.fuzz.judge import is_accepted
from tests.fuzz.mutation import mutated, of_bytes
from tests.stagectl.experiments.piezo.simulated_models import simulated_model
from vibractl import model_file as vibrator_file
from vibractl.library.entry import TOLD, UNITS, Entry, EntryError, read_entry, write_entry
from vibractl.transfer_matrix import TransferMatrix

LINES = 8
RATE = 1_000.0
OFTEN = (0, 0, 1, 1, 2, 2, 3, 3, 3, 4)
"""Kinds of files, by their place: those of others take a process each."""


def cases(folder: Path) -> Callable[[int], bool]:
    """Return what reads the damaged file of a number, and says whether it was accepted."""
    path = folder / "x.h5"
    kinds: tuple[tuple[bytes, Callable[[Path], Any], type[Exception]], ...] = (
        (_written(lambda place: vibrator_file.write_model(place, _matrix())), vibrator_file.read_model, ModelFileError),
        (
            _written(lambda place: stage_file.write_model(place, simulated_model("z"))),
            stage_file.read_model,
            ModelFileError,
        ),
        (_written(lambda place: write_hysteresis(place, _hysteresis())), read_hysteresis, ModelFileError),
        (_written(lambda place: write_entry(place, _entry())), read_entry, EntryError),
        (_written(_foreign), lambda place: read_channels(place, ["u", "y:2"], None), RecordingError),
    )
    sound = [content for content, *_ in kinds]
    undamaged = []
    for content, read, _ in kinds:
        path.write_bytes(content)
        undamaged.append(read(path))

    def case(number: int) -> bool:
        chance = random.Random(number)
        place = chance.choice(OFTEN)
        content, read, own = kinds[place]
        path.write_bytes(mutated(content, chance, sound, of_bytes))
        return is_accepted(lambda: read(path), lambda found: _check(found, undamaged[place]), own)

    return case


def _check(found: Any, whole: Any) -> None:
    """Look at rate, length and numbers; of our own files at every value, since they have a checksum."""
    if isinstance(found, Recording):
        assert 0 < found.rate < np.inf, f"{found.rate} samples/s"
        assert np.isfinite(found.data).all(), "NaN"
        assert found.data.shape == whole.data.shape, f"{found.data.shape}, not {whole.data.shape}"
        return
    for field in fields(found):
        before, after = getattr(whole, field.name), getattr(found, field.name)
        assert np.array_equal(after, before), f"{field.name} is {str(after)[:60]}, not {str(before)[:60]}"


def _written(write: Callable[[Path], None]) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "x.h5"
        write(path)
        return path.read_bytes()


def _noise(*shape: int) -> np.ndarray:
    return np.random.default_rng(1).normal(size=shape)


def _complex(*shape: int) -> np.ndarray:
    return _noise(*shape) + 1j * _noise(*shape)[::-1]


def _matrix() -> TransferMatrix:
    frequency, shape = np.arange(1.0, LINES + 1), (LINES, 2, 2)
    return TransferMatrix(frequency, _complex(*shape), np.ones(shape), np.ones(shape), {"rig": "x", "date": "today"})


def _hysteresis() -> HysteresisModel:
    parts = np.array([0.0, 1e-6, 0.0, 0.0]), np.array([0.1, 0.0]), np.array([0.0, 0.1])
    return HysteresisModel(-0.1, 0.1, *parts, np.array([0.2, 0.6]), np.array([3e-7, 2e-7]), RATE)


def _entry() -> Entry:
    matrix = _matrix()
    parts = _complex(LINES, 2), _complex(LINES, 2), _complex(LINES, 2), matrix.response, matrix.variance
    assert len(UNITS) == 1 + len(parts)
    return Entry(matrix.frequency, *parts, dict.fromkeys(TOLD, "m/s^2"), {"depth": "10"})


def _foreign(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file.attrs["rate"] = RATE
        file["u"] = _noise(50)
        file["u"].attrs["unit"] = "V"
        file["y"] = _noise(50, 2).astype("float32")
