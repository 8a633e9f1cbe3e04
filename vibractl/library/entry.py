"""One entry of the library as an HDF5 file: a learned drive, what it made, and where it came from."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from rigkit.sealed_file import UNREADABLE, opened, sealed, whole

FORMAT = "vibrostage learned drive 1"
UNITS = {
    "frequency": "Hz",
    "drive": "V s",
    "reference": "m/s^2 s",
    "error": "m/s^2 s",
    "model": "m/s^2/V",
    "variance": "(m/s^2/V)^2",
}
"""Learned from hydrophones, with Pa for m/s^2."""
TOLD = (
    "name",
    "rig",
    "wiring",
    "reference_text",
    "reference_hash",
    "run",
    "shot",
    "date",
    "software",
    "law",
    "unit",
    "met",
)
"""What every entry says of itself, in words."""


class EntryError(ValueError):
    """A file that is not a usable entry, or an entry that does not fit."""


@dataclass(frozen=True, eq=False)
class Entry:
    """A learned drive, on the lines that were learned.

    Parameters
    ----------
    frequency : array, shape (lines,), Hz, rising
    drive : complex array, shape (lines, inputs), V s
    reference : complex array, shape (lines, outputs), m/s^2 s
    error : complex array, shape (lines, outputs), m/s^2 s
        Reference minus response to the drive.
    model : complex array, shape (lines, outputs, inputs), m/s^2 per V
        G as believed at the end of the run.
    variance : array, shape (lines, outputs, inputs), (m/s^2 per V)^2
        Of the model's elements.
    about : mapping of strings
        `TOLD`, in words.
    tags : mapping of strings
        Free.

    Raises
    ------
    EntryError : shapes disagree, the grid does not rise, a value is not finite, the drive is silent, or words lack.
    """

    frequency: np.ndarray
    drive: np.ndarray
    reference: np.ndarray
    error: np.ndarray
    model: np.ndarray
    variance: np.ndarray
    about: Mapping[str, str]
    tags: Mapping[str, str]

    def __post_init__(self) -> None:
        """Refuse an entry that is not one."""
        for name in UNITS:
            value = getattr(self, name)
            if value.dtype.kind not in ("fc" if name in ("drive", "reference", "error", "model") else "f"):
                raise EntryError(f"{name} holds {value.dtype}, must hold numbers")
            if not np.isfinite(value).all():
                raise EntryError(f"{name} is not finite at bin {np.argwhere(~np.isfinite(value))[0][0]}")
        lines, outputs, inputs = self.model.shape if self.model.ndim == 3 else (0, 0, 0)
        wanted = {"frequency": (lines,), "drive": (lines, inputs), "reference": (lines, outputs)}
        wanted |= {"error": (lines, outputs), "variance": (lines, outputs, inputs)}
        for name, shape in wanted.items():
            if getattr(self, name).shape != shape or not lines:
                raise EntryError(f"{name} has shape {getattr(self, name).shape}, the model {self.model.shape}")
        if not np.all(np.diff(self.frequency) > 0):
            raise EntryError("the frequencies must rise")
        if not np.any(self.drive):
            raise EntryError("the drive is silent")
        if lacking := [name for name in TOLD if name not in self.about]:
            raise EntryError(f"it does not say its {', '.join(lacking)}")

    @property
    def response(self) -> np.ndarray:
        """What the drive made, (lines, outputs), m/s^2 s."""
        response: np.ndarray = self.reference - self.error
        return response

    @property
    def name(self) -> str:
        """What it is called in its library."""
        return self.about["name"]

    def named(self, name: str) -> "Entry":
        """Return it under another name."""
        return replace(self, about={**self.about, "name": name})


def write_entry(path: Path, entry: Entry) -> None:
    """Write an entry, whole or not at all."""
    with sealed(path) as file:
        file.attrs["format"] = FORMAT
        for name, unit in UNITS.items():
            told = unit.replace("m/s^2", entry.about["unit"])
            file.create_dataset(name, data=getattr(entry, name)).attrs["unit"] = told
        for group in ("about", "tags"):
            attributes = file.create_group(group).attrs
            for name, text in getattr(entry, group).items():
                attributes[name] = text


def read_entry(path: Path) -> Entry:
    """Read an entry.

    Raises
    ------
    EntryError : no such file, another format, or damaged.
    """
    if not path.is_file():
        raise EntryError(f"{path}: there is no such entry")
    try:
        with opened(path) as file:
            if file.attrs.get("format") != FORMAT:
                raise EntryError(f"format is {file.attrs.get('format')!r}, must be {FORMAT!r}")
            parts = {name: whole(file[name]) for name in UNITS}
            about, tags = ({key: str(text) for key, text in file[name].attrs.items()} for name in ("about", "tags"))
            return Entry(about=about, tags=tags, **parts)
    except EntryError as fault:
        raise EntryError(f"{path}: {fault}") from None
    except UNREADABLE as fault:
        raise EntryError(f"{path}: not a readable entry ({' '.join(str(fault).split())})") from None
