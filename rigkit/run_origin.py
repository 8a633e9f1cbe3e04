"""What a run began with, in its folder, and whether it may go on with what is there now."""

import sys
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from rigkit.agreement import GOING_ON, Difference, Use, accepted, agreed, changed_parts, differences
from rigkit.lock import holder
from rigkit.origin import RUN, Origin, checksum, read_origin
from rigkit.provenance import now
from rigkit.run_folder import LOCK, RunFolder

WAY_OUT = "put back what it began with, or begin a new run"


def keep_origin(
    folder: RunFolder,
    kind: str,
    config: BaseModel,
    parts: Sequence[str],
    accept: Sequence[str],
    designed: Mapping[str, Any] | None = None,
) -> None:
    """Write into the folder of a new run what it begins with.

    Parameters
    ----------
    folder : RunFolder
        With all `parts` in it.
    kind : str
        Such as "vibrator run".
    config : Section
        As written to its config.toml.
    parts : sequence of str
        Names of the files in the folder that the run is made of.
    accept : sequence of str
        Keys whose difference has been accepted.
    designed : mapping, optional
        As of `Origin`.
    """
    origin = Origin.of(kind, config, {name: folder.path / name for name in parts})
    origin = replace(origin, designed=designed or {})
    folder.write(RUN, origin.accepting(accept).text)


def refuse_other_kind(path: Path, kinds: Collection[str]) -> None:
    """Refuse, by ValueError, a folder that says that its run is of another kind than these."""
    origin = read_origin(path / RUN)
    if origin is not None and origin.kind not in kinds:
        raise ValueError(f"{path}: its {RUN} has kind {origin.kind!r}, must be one of {', '.join(kinds)}")


def finish(path: Path) -> None:
    """Write into a run's folder that all that was to come of it is there, and since when."""
    if (origin := read_origin(path / RUN)) is not None:
        replace(origin, finished=now()).write(path / RUN)


def changed(path: Path, config: BaseModel, use: Use = GOING_ON) -> list[Difference] | None:
    """Return what has changed in a run's folder since it began; None where it does not say what it began with.

    Parameters
    ----------
    path : Path
        Of the folder.
    config : Section
        As its config.toml has it now.
    use : Use
    """
    origin = read_origin(path / RUN)
    if origin is None:
        return None
    there = {name: checksum(path / name) for name in origin.parts if (path / name).is_file()}
    return [*differences(origin.settings, config, use), *changed_parts(origin, there)]


def going_on(folder: RunFolder, config: BaseModel, accept: Collection[str], use: Use = GOING_ON) -> list[str]:
    """Refuse to go on with a run whose folder has changed; return what is to be said, and keep what was accepted.

    Parameters
    ----------
    folder : RunFolder
    config : Section
        As its config.toml has it now.
    accept : collection of str
        Keys.
    use : Use

    Raises
    ------
    DisagreementError : something has changed that would spoil it.
    """
    path = folder.path
    found = changed(path, config, use)
    if found is None:
        return [f"{path}/ does not say what it began with (no {RUN}): its drives alone are compared"]
    notes = agreed(found, accept, f"{path}/ has changed since the run began", WAY_OUT)
    keys = accepted(found, accept)
    if keys:
        take_over(folder, config, keys)
    return notes


def say_changed(path: Path, config: BaseModel, use: Use = GOING_ON) -> None:
    """Say, on the standard error, what of a run has changed since it was made.

    Parameters
    ----------
    path : Path
        Of its folder.
    config : Section
        As its config.toml has it now.
    use : Use
    """
    for each in changed(path, config, use) or []:
        sys.stderr.write(f"{path}/ has changed since the run was made: {each.text}\n")


def say_at_work(path: Path) -> None:
    """Say, on the standard error, where a process is at work in a run's folder: the recording so far is used."""
    if (process := holder(path / LOCK)) is not None:
        sys.stderr.write(f"process {process} is at work in {path}/: the recording so far is used\n")


def take_over(folder: RunFolder, config: BaseModel, keys: Sequence[str]) -> None:
    """Have a run go on with other settings or parts, and say so in its record and its events.

    Parameters
    ----------
    folder : RunFolder
    config : Section
        As its config.toml has it now.
    keys : sequence of str
        That were accepted, or changed while it ran.
    """
    origin = read_origin(folder.path / RUN)
    if origin is None:
        return
    now = Origin.of(origin.kind, config, {name: folder.path / name for name in origin.parts})
    kept = replace(origin, settings=now.settings, parts=now.parts).accepting(keys)
    folder.write(RUN, kept.text)
    folder.event("accepted", {"keys": sorted(keys)})
