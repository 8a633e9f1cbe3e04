"""Where a learning stands that other software plays: one file with its settings, its model and all that was heard."""

import hashlib
import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Self

import h5py
import numpy as np

from rigkit.sealed_file import UNREADABLE, opened, sealed, whole

FORMAT = "vibrostage step state 1"
_PARTS, _STEPS, _MAINS = "parts", "steps", "mains_"


class StepStateError(ValueError):
    """A file that is not the state of a learning."""


@dataclass(frozen=True)
class Step:
    """A shot that was learned from.

    Parameters
    ----------
    heard : complex array, shape (lines, outputs), m/s^2 s
    noise : array, shape (lines, outputs), (m/s^2 s)^2
    recording : str
        SHA-256 of the response's samples.
    marks : mapping
        What it was worth, as JSON holds it.
    mains : tuple of arrays
        What its silences show of the mains; see `vibractl.mains.Pieces`.
    """

    heard: np.ndarray
    noise: np.ndarray
    recording: str
    marks: Mapping[str, Any]
    mains: tuple[np.ndarray, ...] = ()


@dataclass(frozen=True)
class StepState:
    """A learning between two shots.

    Parameters
    ----------
    parts : mapping of str to bytes
        The files that a run's folder would begin with, by their names.
    steps : tuple of Step
    fraction : float, samples
        By which the first shot came later than on a whole sample.
    """

    parts: Mapping[str, bytes]
    steps: tuple[Step, ...] = ()
    fraction: float = 0.0

    @classmethod
    def of_folder(cls, path: Path) -> Self:
        """Return the beginning of a learning from the folder of a run that has no shot yet."""
        files = [each for each in path.iterdir() if each.is_file() and not each.name.startswith(".")]
        return cls({each.name: each.read_bytes() for each in files})

    @classmethod
    def read(cls, path: Path) -> Self:
        """Read it from a file.

        Raises
        ------
        StepStateError : no such file, another kind of file, or one that was changed or damaged.
        """
        if not path.is_file():
            raise StepStateError(f"{path}: no such state file")
        try:
            with opened(path) as file:
                if file.attrs.get("format") != FORMAT:
                    raise StepStateError(f"{path}: format is {file.attrs.get('format')!r}, must be {FORMAT!r}")
                parts = {name: whole(item).tobytes() for name, item in file[_PARTS].items()}
                steps = [_step(file[_STEPS][name]) for name in sorted(file[_STEPS])]
                return cls(parts, tuple(steps), float(file.attrs["fraction"]))
        except StepStateError:
            raise
        except UNREADABLE as fault:
            raise StepStateError(f"{path}: {fault}") from None

    def write(self, path: Path) -> None:
        """Write it to a file, whole or not at all."""
        with sealed(path) as file:
            file.attrs["format"], file.attrs["fraction"] = FORMAT, self.fraction
            parts, steps = file.create_group(_PARTS), file.create_group(_STEPS)
            for name, content in self.parts.items():
                parts.create_dataset(name, data=np.frombuffer(content, np.uint8))
            for number, step in enumerate(self.steps):
                group = steps.create_group(f"{number:06d}")
                group.create_dataset("heard", data=step.heard).attrs["unit"] = "m/s^2 s"
                group.create_dataset("noise", data=step.noise).attrs["unit"] = "(m/s^2 s)^2"
                for place, pieces in enumerate(step.mains):
                    group.create_dataset(f"{_MAINS}{place}", data=pieces).attrs["unit"] = "m/s^2"
                group.attrs["recording"], group.attrs["marks"] = step.recording, json.dumps(dict(step.marks))

    @contextmanager
    def folder(self) -> Iterator[Path]:
        """Give its parts as the files of a folder, for as long as the block lasts."""
        with TemporaryDirectory(prefix="vibractl-step-") as place:
            for name, content in self.parts.items():
                (Path(place) / name).write_bytes(content)
            yield Path(place)

    def after(self, step: Step, fraction: float) -> "StepState":
        """Return it with one more shot; the first one's fraction stays."""
        return replace(self, steps=(*self.steps, step), fraction=self.fraction if self.steps else fraction)


def checksum(samples: np.ndarray) -> str:
    """Return the SHA-256 of samples, any shape and unit."""
    return hashlib.sha256(samples.tobytes()).hexdigest()


def _step(group: h5py.Group) -> Step:
    marks = json.loads(group.attrs["marks"])
    mains = tuple(whole(group[name]) for name in sorted(group) if name.startswith(_MAINS))
    return Step(whole(group["heard"]), whole(group["noise"]), str(group.attrs["recording"]), marks, mains)
