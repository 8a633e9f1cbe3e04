"""Runs of every kind: how each is reported and replayed."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from ctlblocks.recording import Recording
from rigkit.experiment import again, kept
from rigkit.experiment.kind import Kind, kind_of
from rigkit.experiment.replayed import Replayed
from stagectl.experiments.kinds import KINDS
from stagectl.experiments.piezo.replay import remade as from_log
from stagectl.experiments.piezo.replay import replay
from stagectl.experiments.piezo.report import run_report
from stagectl.experiments.piezo.run_setup import setup_as_run, setup_of
from stagectl.experiments.piezo.setup import Setup


def reported(path: Path, png: Path | None) -> dict[str, Any]:
    """Write the report of a run, and figures as PNG files where they are wanted; return its figures."""
    if (kind := _kind(path)) is not None:
        return kept.reported(path, kind, png)
    return run_report(path, png)


def replayed(path: Path, settings: Sequence[str] = ()) -> Iterator[Replayed]:
    """Make every recording of a run again, with settings laid over its rig file.

    Raises
    ------
    ValueError : settings for a kind of run that is replayed with its own only.
    """
    kind = _kind(path)
    if settings and kind is not None and not kind.what_if:
        known = ", ".join(sorted([*(name for name, each in KINDS.items() if each.what_if), "stage runs"]))
        raise ValueError(f"{path}: --set is {settings[0]!r}, must not be given but for: {known}")
    if kind is not None:
        return again.replayed(path, kind, settings)
    return replay(path, _stage(path, settings))


def remade(
    path: Path, settings: Sequence[str], read: Callable[[Recording, list[str]], Recording]
) -> tuple[Recording, Recording]:
    """Make what a run's controllers would have made of somebody's log; return the log, and that.

    Parameters
    ----------
    path : Path
        Of the run's folder.
    settings : sequence of str
        Laid over its rig file.
    read : callable(Recording, list of str) -> Recording
        As of `again.remade`.

    Raises
    ------
    ValueError : a kind of run whose graph takes no log, settings for the stage's, or as of `again.remade`.
    """
    if (kind := _kind(path)) is not None and kind.what_if:
        return again.remade(path, kind, settings, read)
    if kind is not None:
        raise ValueError(f"{path}: is a run of trials or of pockets, must be of mid-ranging, steps or a stage")
    return from_log(path, _stage(path, settings), read)


def _stage(path: Path, settings: Sequence[str]) -> Setup:
    """Return a stage's run as it went, or designed anew by other settings."""
    return setup_of(path, settings) if settings else setup_as_run(path)


def _kind(path: Path) -> Kind | None:
    """Return the kind of a run that the one runner knows; a folder that does not say so, by a file that only it has."""
    known = kind_of(path)
    return KINDS.get(known) if known else next((kind for kind in KINDS.values() if kind.is_older(path)), None)
