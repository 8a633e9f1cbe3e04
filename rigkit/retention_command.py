"""The command `prune` of every rig: old runs are deleted, or shown."""

import time
from pathlib import Path
from typing import Annotated

import typer

from ctlblocks.room import free, megabytes
from rigkit.command import JsonOption, print_table, words, write_json
from rigkit.retention import DAY, Policy, prune, stored_runs, superfluous


def prune_command(
    root: Annotated[Path, typer.Argument(metavar="RUNS/", help="Folder that contains the folders of runs.")],
    newest: Annotated[int | None, typer.Option(min=1, help="Keep this number of runs, the newest.")] = None,
    gigabytes: Annotated[float | None, typer.Option(min=0.0, help="Keep this size, from the newest run on.")] = None,
    days: Annotated[float | None, typer.Option(min=0.0, help="Keep runs changed within this number of days.")] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only show what would be deleted.")] = False,
    json: JsonOption = None,
) -> None:
    """Delete old runs; never the newest, one in progress, or one with a file `keep` in its folder.

    Example: `prune runs/ --gigabytes 200 --days 90 --dry-run`; to protect a run: `touch runs/RUN/keep`
    """
    policy = Policy(newest, None if gigabytes is None else 1e9 * gigabytes, days)
    if policy == Policy():
        raise ValueError("prune needs at least one of --newest, --gigabytes and --days: which runs to keep")
    now, runs = time.time(), stored_runs(root)
    if dry_run:
        done = [(run, True) for run in superfluous(runs, policy, now)]
    else:
        done = list(prune(root, policy))
    rows = [
        [str(run.path), megabytes(run.size), f"{(now - run.changed) / DAY:.1f}", _verdict(is_gone, dry_run)]
        for run, is_gone in done
    ]
    print_table(f"{root}: {len(runs)} runs", ["run", "size", "days old", ""], rows, words(json))
    misdated = [str(run.path) for run in runs if run.is_misdated]
    if misdated:
        print(f"not deleted, implausible dates: {', '.join(misdated)}", file=words(json))  # noqa: T201
    gone = [run for run, is_gone in done if is_gone]
    freed = sum(run.size for run in gone)
    print(
        f"{_verdict(True, dry_run)}: {len(gone)} runs, {megabytes(freed)}; free: {megabytes(free(root))}",
        file=words(json),
    )  # noqa: T201
    write_json(
        json, {"deleted": [str(run.path) for run in gone], "misdated": misdated, "bytes": freed, "dry_run": dry_run}
    )


def _verdict(is_gone: bool, dry_run: bool) -> str:
    return ("would be deleted" if dry_run else "deleted") if is_gone else "in progress, not deleted"
