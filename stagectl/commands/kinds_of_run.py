"""Runs of every kind: how each is reported and replayed."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from ctlblocks.recording import Recording
from rigkit.experiment import again, kept
from rigkit.experiment.kind import Kind, kind_of
from rigkit.experiment.replayed import Replayed
from rigkit.run_origin import refuse_other_kind
from stagectl.experiments.kinds import KINDS
from stagectl.experiments.piezo.experiment import STAGE_RUN


def reported(path: Path, png: Path | None) -> dict[str, Any]:
    """Write the report of a run, and figures as PNG files where they are wanted; return its figures."""
    return kept.reported(path, _kind(path), png)


def replayed(path: Path, settings: Sequence[str] = ()) -> Iterator[Replayed]:
    """Make every recording of a run again, with settings laid over its rig file.

    Raises
    ------
    ValueError : settings for a kind of run that is replayed with its own only.
    """
    kind = _kind(path)
    if settings and not kind.what_if:
        known = ", ".join(sorted(name for name, each in KINDS.items() if each.what_if))
        raise ValueError(f"{path}: --set is {settings[0]!r}, must not be given but for: {known}")
    return again.replayed(path, kind, settings)


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
    ValueError : a kind of run whose graph takes no log, or as of `again.remade`.
    """
    kind = _kind(path)
    if not kind.what_if:
        raise ValueError(f"{path}: is a run of trials or of pockets, must be of mid-ranging, steps or a stage")
    return again.remade(path, kind, settings, read)


def _kind(path: Path) -> Kind:
    """Return the kind of a run; a folder that does not say so, by a file that only it has, or else a stage's."""
    refuse_other_kind(path, KINDS)
    if name := kind_of(path):
        return KINDS[name]
    return next((kind for kind in KINDS.values() if kind.is_older(path)), STAGE_RUN)
