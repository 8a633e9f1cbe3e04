"""Runs of every kind: how each is reported and replayed."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from rigkit.experiment import kept
from rigkit.experiment.kind import Kind, kind_of
from rigkit.experiment.replayed import Replayed
from stagectl import session
from stagectl.experiments.kinds import KINDS
from stagectl.experiments.toroid.read_back import STAGE, TOROID
from stagectl.feed.folder import is_of_feed, replay_folder, report_folder
from stagectl.replay import replay
from stagectl.report import run_report
from stagectl.trials.job import report_again
from stagectl.trials.replay import replay_trials
from stagectl.trials.session import is_of_trials


def reported(path: Path, png: Path | None) -> dict[str, Any]:
    """Write the report of a run, and figures as PNG files where they are wanted; return its figures."""
    if (kind := _kind(path)) is not None:
        return kept.reported(path, kind, png)
    if is_of_feed(path):
        return report_folder(path, png)
    if is_of_trials(path):
        return report_again(path, png)
    return run_report(path, png)


def replayed(path: Path) -> Iterator[Replayed]:
    """Make every recording of a run again."""
    if (kind := _kind(path)) is not None:
        return kept.replayed(path, kind)
    if is_of_feed(path):
        return replay_folder(path)
    if is_of_trials(path):
        return replay_trials(path)
    return replay(path, session.setup_of(path))


def _kind(path: Path) -> Kind | None:
    """Return the kind of a run that the one runner knows; a folder that does not say so has the stage's rig file."""
    known = kind_of(path) or (TOROID.name if (path / STAGE).is_file() else "")
    return KINDS.get(known)
