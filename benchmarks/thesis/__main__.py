"""The thesis' table: runs what its rows need, and says or writes what came of it.

`python -m benchmarks.thesis [--only 5.7 ...] [--write] [--folder runs/thesis]`; what is done already in the folder is
not run again.  `--write` keeps the values in docs/thesis.json and writes docs/thesis.md; with `--only` the others stay
as they are kept.  `--case NAME [FILE ...]` prints one of the figures of `benchmarks.thesis.made` and runs nothing else.
"""

import argparse
import json
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NoReturn

from benchmarks.machine import machine
from benchmarks.page_table import DOCS
from benchmarks.thesis import made
from benchmarks.thesis.groups import groups, ordered, run
from benchmarks.thesis.page import page
from benchmarks.thesis.rows import Row, chapters, chosen
from rigkit import atomic
from rigkit.json_text import json_text

KEPT, PAGE = DOCS / "thesis.json", DOCS / "thesis.md"
FOLDER = DOCS.parent / "runs" / "thesis"


def values_of(rows: Sequence[Row], folder: Path) -> tuple[dict[str, Any], dict[str, Any], list[str]]:
    """Run what rows need; return their values, what is kept of the groups, and a line for each that failed.

    Parameters
    ----------
    rows : sequence of Row
    folder : Path
    """
    values: dict[str, Any] = {}
    done: dict[str, Any] = {}
    failed: list[str] = []
    known = groups()
    for group in ordered({row.group for row in rows if row.group}, known):
        try:
            done[group.name] = {key: value for key, value in run(group, folder).items() if key != "commands"}
        except (RuntimeError, ValueError, OSError) as fault:
            failed.append(str(fault))
    for row in rows:
        if row.group in done:
            ours = values[row.key] = row.ours(folder)
            print(f"{row.at:10} {row.what:70} {row.printed:24} {row.told(ours):16} {row.verdict(ours)}")
    return values, done, failed


def main() -> int:
    """Run, print, and keep where that is asked for."""
    asked, refuse = _asked()
    if asked.case:
        print(json_text(made.CASES[asked.case[0]](*asked.case[1:]), indent=2))
        return 0
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    whole = chapters()
    try:
        rows = chosen(asked.only, whole)
    except ValueError as wrong:
        refuse(str(wrong))
    values, done, failed = values_of(rows, asked.folder)
    print("\n".join(failed), file=sys.stderr)
    if asked.write and not failed:
        before = json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() and asked.only else {}
        kept = {
            "machine": machine(),
            "values": before.get("values", {}) | values,
            "groups": before.get("groups", {}) | done,
        }
        atomic.write(KEPT, f"{json_text(kept, indent=2)}\n")
        atomic.write(PAGE, page(whole, groups(), kept))
    return 1 if failed else 0


def _asked() -> tuple[argparse.Namespace, Callable[[str], NoReturn]]:
    words = argparse.ArgumentParser(prog="python -m benchmarks.thesis")
    words.add_argument("--only", nargs="+", default=[], metavar="FIGURE", help="such as 5.7, 'Tab. 5.1', or a chapter")
    words.add_argument("--write", action="store_true", help="keep the values, and write the page")
    words.add_argument("--folder", type=Path, default=FOLDER, help="where the groups run")
    words.add_argument("--case", nargs="+", metavar="CASE", help="print a figure that no program prints")
    return words.parse_args(), words.error


if __name__ == "__main__":
    sys.exit(main())
