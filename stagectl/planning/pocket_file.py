"""Files of pockets and paths: JSON, as a person writes them and as planners leave them."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rigkit import atomic
from rigkit.json_file import JsonError, read_json
from stagectl.planning.problem import Pocket, PocketFault


def read_pocket(path: Path) -> Pocket:
    """Read a pocket.

    Raises
    ------
    PocketFault : the file holds no JSON, or no pocket; the text begins with the file's name.
    OSError : it cannot be read.
    """
    try:
        given = read_json(path, dict)
    except JsonError as fault:
        raise PocketFault(str(fault)) from None
    try:
        return Pocket.from_dict(given)
    except PocketFault as fault:
        raise PocketFault(f"{path}: {fault}") from None


def read_path(path: Path) -> list[Any]:
    """Read a path: a list of [type, row, col, feed], whose segments `check` looks at.

    Raises
    ------
    PocketFault : the file holds no JSON, or no list.
    OSError : it cannot be read.
    """
    try:
        return read_json(path, list)
    except JsonError as fault:
        raise PocketFault(f"{fault}; a path is a list of [type, row, col, feed]") from None


def write_path(path: Path, segments: Sequence[Sequence[str | int]]) -> None:
    """Write a path, a segment a line."""
    lines = ",\n ".join(json.dumps(list(each)) for each in segments)
    atomic.write(path, f"[{lines}]\n")
