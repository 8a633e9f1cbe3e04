"""The report of a run."""

from pathlib import Path
from typing import Any

from rigkit.run_folder import read_quality
from vibractl.session import summary


def run_report(path: Path, png: Path | None = None) -> dict[str, Any]:
    """Draw."""
    return summary(read_quality(path))
