"""Files of pockets and paths: JSON, as a person writes them and as planners leave them."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rigkit import atomic
from stagectl.planning.problem import Pocket, PocketFault


def read_pocket(path: Path) -> Pocket:
    """Read a pocket.

    Raises
    ------
    PocketFault : the file holds no JSON, or no pocket; the text begins with the file's name.
    OSError : it cannot be read.
    """
    given = _json(path)
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
    given = _json(path)
    if not isinstance(given, list):
        raise PocketFault(f"{path}: a path is {type(given).__name__}, must be a list of [type, row, col, feed]")
    return given


def write_path(path: Path, segments: Sequence[Sequence[str | int]]) -> None:
    """Write a path, a segment a line."""
    lines = ",\n ".join(json.dumps(list(each)) for each in segments)
    atomic.write(path, f"[{lines}]\n")


def _json(path: Path) -> Any:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (json.JSONDecodeError, UnicodeDecodeError) as fault:
        raise PocketFault(f"{path}: {fault}, must be JSON") from None
