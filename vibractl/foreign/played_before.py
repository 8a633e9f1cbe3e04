"""What a simulated vibrator was driven with before, in a file: played again, it is as it was left."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self

import numpy as np

from rigkit.json_text import json_text
from rigkit.sealed_file import UNREADABLE, opened, sealed, whole

FORMAT = "vibrostage simulated vibrator 1"


class PlayedBeforeError(ValueError):
    """A file that is not of this simulated vibrator."""


@dataclass(frozen=True)
class PlayedBefore:
    """All drives of a simulated vibrator since it was at rest.

    Parameters
    ----------
    machine : mapping
        What it is and how it is wired: of the rig file's tables, as JSON holds it.
    drives : tuple of float32 arrays, shape (samples, drives), V
    """

    machine: Mapping[str, Any]
    drives: tuple[np.ndarray, ...] = ()

    @classmethod
    def read(cls, path: Path, machine: Mapping[str, Any]) -> Self:
        """Read it from a file; nothing was played where there is none.

        Raises
        ------
        PlayedBeforeError : another kind of file, one that was changed or damaged, or of another machine.
        """
        wanted = json.loads(json_text(machine))
        if not path.exists():
            return cls(wanted)
        try:
            with opened(path) as file:
                if file.attrs.get("format") != FORMAT:
                    raise PlayedBeforeError(f"{path}: format is {file.attrs.get('format')!r}, must be {FORMAT!r}")
                there = json.loads(file.attrs["machine"])
                drives = tuple(whole(file[f"{number:06d}"]) for number in range(int(file.attrs["count"])))
        except PlayedBeforeError:
            raise
        except UNREADABLE as fault:
            raise PlayedBeforeError(f"{path}: {fault}") from None
        for key in dict.fromkeys([*there, *wanted]):
            if there.get(key) != wanted.get(key):
                raise PlayedBeforeError(
                    f"{path}: {key} was {there.get(key)}, is {wanted.get(key)}: that is another plant, begin with "
                    "another --state"
                )
        return cls(there, drives)

    def write(self, path: Path) -> None:
        """Write it to a file, whole or not at all."""
        with sealed(path) as file:
            file.attrs["format"], file.attrs["machine"] = FORMAT, json_text(self.machine)
            file.attrs["count"] = len(self.drives)
            for number, drive in enumerate(self.drives):
                file.create_dataset(f"{number:06d}", data=drive).attrs["unit"] = "V"

    def after(self, drive: np.ndarray) -> "PlayedBefore":
        """Return it with one more drive (samples, drives), V."""
        return replace(self, drives=(*self.drives, drive))
