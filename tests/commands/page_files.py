"""Which files a command reads and writes, as far as its words say so."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tests.commands.dry_parse import Parsed

WRITTEN = frozenset(
    (
        "--file",
        "--out",
        "--json",
        "--png",
        "--report",
        "--record",
        "--gcode",
        "--rapid",
        "--log",
        "--path",
        "--folder",
        "--state",
        "--prior",
    )
)
"""Options whose files a command makes."""
SUFFIXES = frozenset((".toml", ".csv", ".h5", ".json", ".wav"))


def reads(parsed: Parsed) -> list[Path]:
    """Return the files and folders that must be there: those that are no results, and devices among the settings."""
    given = [(option, value) for option, values in parsed.options.items() for value in values]
    return [path for option, value in given if option not in WRITTEN for path in _paths(option, value)]


def writes(parsed: Parsed) -> list[Path]:
    """Return the files and folders that are there afterwards; a stage's calibration makes a rig file, too."""
    made = [Path(value) for option, values in parsed.options.items() if option in WRITTEN for value in values]
    return made + [each.with_suffix(".toml") for each in made if parsed.name == "stage" and each.suffix == ".h5"]


def is_made(path: Path, made: list[Path]) -> bool:
    """Whether a file is one of those that were made, or in one of their folders, or a part of one, as x-AXIS.h5 is."""
    return any(path == each or each in path.parents or _is_part(path, each) for each in made)


def _is_part(path: Path, whole: Path) -> bool:
    return path.parent == whole.parent and path.suffix == whole.suffix and path.stem.startswith(f"{whole.stem}-")


def _paths(option: str, value: Any) -> Iterator[Path]:
    text = str(value).partition("=")[2] if option == "--set" else value
    if isinstance(text, Path) or (isinstance(text, str) and _is_file(text)):
        yield Path(text)


def _is_file(text: str) -> bool:
    return text.startswith("/") or Path(text).suffix in SUFFIXES
