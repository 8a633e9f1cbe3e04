"""A model as an HDF5 file: arrays with units, words, and where it came from; there whole or not at all."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np

from rigkit.sealed_file import UNREADABLE, opened, sealed, whole

_PROVENANCE = "provenance."


class ModelFileError(ValueError):
    """A file that is not a usable model of this rig."""


@dataclass(frozen=True)
class ModelFile:
    """What a model file holds.

    Parameters
    ----------
    format : str
        Which kind of model, and which version of its layout; compared before anything else is read.
    arrays : mapping of arrays, any shape and unit
    units : mapping of strings
        The unit of each array that has one.
    words : mapping of strings or sequences of strings
        Names and other text.
    provenance : mapping of strings
        From which recording, configuration and commit it came.
    """

    format: str
    arrays: Mapping[str, np.ndarray]
    units: Mapping[str, str] = field(default_factory=dict)
    words: Mapping[str, str | Sequence[str]] = field(default_factory=dict)
    provenance: Mapping[str, str] = field(default_factory=dict)


def write_model_file(path: Path, content: ModelFile) -> None:
    """Write `content` to `path`, whole or not at all."""
    with sealed(path) as file:
        file.attrs["format"] = content.format
        for name, array in content.arrays.items():
            dataset = file.create_dataset(name, data=array)
            if name in content.units:
                dataset.attrs["unit"] = content.units[name]
        for name, words in content.words.items():
            file.attrs[name] = words if isinstance(words, str) else np.array(list(words), h5py.string_dtype())
        for name, text in content.provenance.items():
            file.attrs[_PROVENANCE + name] = text


def read_model_file(
    path: Path, expected: str, arrays: Sequence[str], words: Sequence[str] = (), optional: Sequence[str] = ()
) -> ModelFile:
    """Read a model of the kind `expected`, with the `arrays` and `words` it must hold, and `optional` arrays it may.

    Raises
    ------
    ModelFileError : no such file, no readable HDF5, another kind of model, something is missing, or it was changed.
    """
    if not path.is_file():
        raise ModelFileError(f"{path}: no such model file")
    try:
        with opened(path) as file:
            if (found := file.attrs.get("format")) != expected:
                raise ModelFileError(f"{path}: format is {found!r}, must be {expected!r}")
            arrays = [*arrays, *(name for name in optional if name in file)]
            return ModelFile(
                expected,
                arrays={name: whole(file[name]) for name in arrays},
                units={name: str(file[name].attrs["unit"]) for name in arrays if "unit" in file[name].attrs},
                words={name: _words(file.attrs[name]) for name in words},
                provenance={
                    name.removeprefix(_PROVENANCE): str(text)
                    for name, text in file.attrs.items()
                    if name.startswith(_PROVENANCE)
                },
            )
    except ModelFileError:
        raise
    except UNREADABLE as fault:
        raise ModelFileError(f"{path}: not a readable model file ({' '.join(str(fault).split())})") from None


def _words(value: object) -> str | tuple[str, ...]:
    return tuple(str(word) for word in value) if isinstance(value, np.ndarray) else str(value)
