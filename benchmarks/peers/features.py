"""The tables of features, from features.toml."""

import tomllib
from pathlib import Path
from typing import Any

from benchmarks.page_table import table

FILE = Path(__file__).with_name("features.toml")
NOT_FOUND = "not found"


def features() -> list[dict[str, Any]]:
    """Return the tables: `title`, `systems`, and `rows` of `feature` and `cells`."""
    found: list[dict[str, Any]] = tomllib.loads(FILE.read_text(encoding="utf-8"))["tables"]
    return found


def sections() -> str:
    """Return all tables under their titles."""
    return "\n\n".join(f"### {each['title']}\n\n{_table(each)}" for each in features())


def _table(found: dict[str, Any]) -> str:
    return table(["", *found["systems"]], [[row["feature"], *map(_cell, row["cells"])] for row in found["rows"]])


def _cell(cell: list[str]) -> str:
    if not cell:
        return NOT_FOUND
    said, link = cell
    return f"{said} ([source]({link}))"
