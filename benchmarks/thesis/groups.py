"""Groups of commands: each runs in a folder of its own, in this process, and is kept there once it is done."""

import contextlib
import io
import json
import resource
import shlex
import shutil
import sys
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.thesis import made
from rigkit import atomic
from rigkit.json_text import json_text
from rigkit.provenance import now, software
from rigkit.study.programs import call

DONE = "done.json"
"""In a group's folder: which of its commands are done, and when the last of them was."""
GOES_ON = "calibrate"
"""The program whose commands go on where they were stopped."""
MADE = "made"
"""First word of a command that is a function of `benchmarks.thesis.made`, and no program's."""
CHAPTERS = tuple(sorted(Path(__file__).parent.glob("chapter_*.toml")))


@dataclass(frozen=True)
class Group:
    """Commands that belong together.

    Parameters
    ----------
    name : str
        Of its folder.
    commands : tuple of str
        In order; `../NAME/` is the folder of another group, which is run before.
    statuses : tuple of int
        Exit statuses that are right: 0, and those by which a program says what is to be shown.
    """

    name: str
    commands: tuple[str, ...]
    statuses: tuple[int, ...] = (0,)

    @property
    def before(self) -> tuple[str, ...]:
        """Names of the groups whose files are read, sorted."""
        words = (word for command in self.commands for word in shlex.split(command))
        return tuple(sorted({word.split("/")[1] for word in words if word.startswith("../")}))


def groups() -> dict[str, Group]:
    """Return all of the chapters' groups by name."""
    chapters = (tomllib.loads(file.read_text(encoding="utf-8")) for file in CHAPTERS)
    return {
        name: Group(name, tuple(said["commands"]), tuple(said.get("statuses", (0,))))
        for chapter in chapters
        for name, said in chapter.get("groups", {}).items()
    }


def ordered(wanted: set[str], known: Mapping[str, Group]) -> list[Group]:
    """Return the groups that are wanted and those that they need, each after those that it needs."""
    order: dict[str, Group] = {}

    def visit(name: str) -> None:
        for before in known[name].before:
            visit(before)
        order.setdefault(name, known[name])

    for name in known:
        if name in wanted:
            visit(name)
    return list(order.values())


def run(group: Group, folder: Path) -> dict[str, Any]:
    """Run what is left of a group in `folder/NAME`, and return what is kept of it.

    A command that was stopped is begun anew: what its `--out` names is removed, but for `calibrate`, which goes on.

    Returns
    -------
    dict
        `commands` that are done, `seconds` (of processor time, float), `time`, `software`.

    Raises
    ------
    RuntimeError : a command has ended with another status than it should.
    """
    place = folder / group.name
    done = _kept(place)
    if done["commands"] != list(group.commands[: len(done["commands"])]):
        shutil.rmtree(place)
        done = _kept(place)
    place.mkdir(parents=True, exist_ok=True)
    for command in group.commands[len(done["commands"]) :]:
        sys.stderr.write(f"{group.name}: {command}\n")
        spent, words = _processor(), shlex.split(command)
        _clear(words, place)
        status = _run(words, place)
        if status not in group.statuses:
            raise RuntimeError(f"{group.name}: {command}: status {status}, must be one of {group.statuses}")
        done["commands"].append(command)
        done |= {"seconds": done["seconds"] + _processor() - spent, "time": now(), "software": software()}
        atomic.write(place / DONE, json_text(done, indent=2))
    return done


def _kept(place: Path) -> dict[str, Any]:
    """Return what is done of a group, from its folder."""
    try:
        kept: dict[str, Any] = json.loads((place / DONE).read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {"commands": [], "seconds": 0.0}
    return kept


def _clear(words: list[str], place: Path) -> None:
    if "--out" in words and words[0] != GOES_ON:
        made = place / words[words.index("--out") + 1]
        if made.is_dir():
            shutil.rmtree(made)
        else:
            made.unlink(missing_ok=True)


def _run(words: list[str], place: Path) -> int:
    with contextlib.chdir(place), contextlib.redirect_stdout(io.StringIO()):
        if words[0] == MADE:
            atomic.write(Path(f"{words[1]}.json"), json_text(made.CASES[words[1]](*words[2:]), indent=2))
            return 0
        return call(words)


def _processor() -> float:
    return sum(used.ru_utime + used.ru_stime for used in _used())


def _used() -> Iterator[resource.struct_rusage]:
    yield from (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
