"""One task, performed in this process: its commands in a folder of their own, then its figures."""

import os
import shutil
import sys
import time
import traceback
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rigkit.json_file import read_json
from rigkit.posix import resource
from rigkit.provenance import now
from rigkit.study import programs
from rigkit.study.json_path import reduced, value_at
from rigkit.study.late_value import with_late_values
from rigkit.study.outcome import DONE, FAULT, Outcome
from rigkit.study.task import Task, Words

PRINTED, TOLD = "stdout.txt", "stderr.txt"
"""In a task's folder: what its commands wrote."""
_OWN = {"XDG_CACHE_HOME": ".cache", "XDG_DATA_HOME": ".data", "XDG_STATE_HOME": ".state"}
"""Folders of a user: those of a task are empty, so that nothing depends on whose machine it is."""
_LONGEST_MESSAGE = 400
_TRACEBACK = "Traceback (most recent call last):"
"""Line by which Python begins to tell a fault of a program."""
_STREAMS = {1: PRINTED, 2: TOLD}


def perform(task: Task, files: Path, scratch: Path) -> Outcome:
    """Run a task's commands one after the other until one fails, and read its figures.

    Parameters
    ----------
    task : Task
    files : Path
        Folder whose files are put into the task's.
    scratch : Path
        Folder in which its own is made.
    """
    place = scratch.resolve() / task.folder
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir(parents=True)
    for file in files.iterdir():
        shutil.copyfile(file, place / file.name)
    began, used = time.monotonic(), _processor_time()
    given: list[Words] = []
    with _living_in(place):
        status, failed, message = _run(task.commands, place, given)
    wall, cpu = time.monotonic() - began, _processor_time() - used
    figures, notes = _figures(task, place)
    if task.keep == "nothing" or (task.keep == "failed" and not status):
        shutil.rmtree(place, ignore_errors=True)
    return Outcome(
        task.key,
        status,
        failed,
        message,
        figures,
        wall,
        cpu,
        now(),
        () if status else tuple(notes),
        tuple(given),
    )


def _run(commands: Sequence[Words], place: Path, given: list[Words]) -> tuple[int, int, str]:
    """Run commands until one fails; return its exit status, which one it is, from 1, and what it told last.

    0, 0 and nothing where none does. What they were given, with the values that earlier ones have written, is added to
    `given`.
    """
    for number, words in enumerate(commands, start=1):
        since = {name: (place / name).stat().st_size for name in _STREAMS.values()}
        status = _status(words, place, given)
        _flush()
        if status:
            return status, number, _message(place, status, since)
    return DONE, 0, ""


def _status(words: Words, place: Path, given: list[Words]) -> int:
    """Run one command; a fault of its program is told as Python does."""
    try:
        given.append(with_late_values(words, place))
        return programs.call(given[-1])
    except BaseException:  # of whatever kind: the task has failed, and the next one is performed
        traceback.print_exc()
        return FAULT


@contextmanager
def _living_in(place: Path) -> Iterator[None]:
    """Work in a folder, with its own files of a user; what is printed goes to files in it."""
    before = {name: os.environ.get(name) for name in _OWN}
    home, kept = Path.cwd(), {number: os.dup(number) for number in _STREAMS}
    os.environ.update({name: str(place / folder) for name, folder in _OWN.items()})
    for number, name in _STREAMS.items():
        file = os.open(place / name, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
        os.dup2(file, number)
        os.close(file)
    os.chdir(place)
    try:
        yield
    finally:
        os.chdir(home)
        _flush()
        for number, stream in kept.items():
            os.dup2(stream, number)
            os.close(stream)
        for name, value in before.items():
            os.environ.pop(name) if value is None else os.environ.update({name: value})


def _flush() -> None:
    """Write what was printed and told to its files."""
    sys.stdout.flush()
    sys.stderr.flush()


def _message(place: Path, status: int, since: Mapping[str, int]) -> str:
    """Return the last line that the command that failed has told, the same in whichever folder.

    A command that was performed, and whose result is not good, says so in what it prints, not among its progress.
    """
    told, printed = (_lines(place / name, since[name]) for name in (TOLD, PRINTED))
    is_verdict = status == FAULT and printed and _TRACEBACK not in told
    lines = printed if is_verdict else told
    return lines[-1].replace(f"{place}/", "").replace(str(place), ".")[:_LONGEST_MESSAGE] if lines else ""


def _lines(file: Path, since: int) -> list[str]:
    """Return the lines of a file from a byte on that are not empty, without the spaces around them."""
    text = file.read_bytes()[since:].decode(errors="replace")
    return [line.strip() for line in text.split("\n") if line.strip()]


def _figures(task: Task, place: Path) -> tuple[dict[str, Any], list[str]]:
    found: dict[str, Any] = dict.fromkeys(task.figures)
    notes, read = [], {}
    for name, figure in task.figures.items():
        file = figure["file"]
        try:
            if file not in read:
                read[file] = read_json(place / file, object)
            value = reduced(value_at(read[file], figure["path"]), figure["reduce"])
            if value is not None and not isinstance(value, str | int | float):
                raise TypeError(f"{figure['path']} is no number and no text; reduce makes one of many")
            found[name] = value
        except OSError as fault:
            notes.append(f"figure {name}: {file}: {fault.strerror}")
        except (LookupError, TypeError, ValueError) as fault:
            notes.append(f"figure {name}: {fault.args[0] if fault.args else fault}")
    return found, notes


def _processor_time() -> float:
    """Return the processor time, s, of this process and of those that it started and that have ended."""
    if resource is None:
        return time.process_time()
    each = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return float(sum(one.ru_utime + one.ru_stime for one in each))
