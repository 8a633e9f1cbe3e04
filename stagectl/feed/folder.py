"""A folder of `stagectl force`, whatever its task was: its report drawn again, its outputs made again."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from rigkit.experiment.replayed import Replayed
from rigkit.run_folder import CONFIG
from stagectl.feed.job import read_job
from stagectl.feed.process_session import process_report, replay_process
from stagectl.feed.replay import replay_feed
from stagectl.feed.report import feed_report
from stagectl.feed.session import JOB


def is_of_feed(path: Path) -> bool:
    """Whether a folder is one of a run of `stagectl force`."""
    return (path / CONFIG).is_file() and (path / JOB).is_file()


def report_folder(path: Path, png: Path | None = None) -> dict[str, Any]:
    """Write `report.html` into a run's folder; return the run's figures.

    Parameters
    ----------
    path : Path
    png : Path, optional
        Folder for the figures as PNG files as well.
    """
    return process_report(path, png) if _has_no_pocket(path) else feed_report(path, png)


def replay_folder(path: Path) -> Iterator[Replayed]:
    """Make every output of a folder's runs again from what was seen; ValueError where nothing is recorded."""
    return replay_process(path) if _has_no_pocket(path) else replay_feed(path)


def _has_no_pocket(path: Path) -> bool:
    return read_job(path / JOB).pocket is None
