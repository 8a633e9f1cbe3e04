"""What a command is to write: refused before anything is done where it cannot be, or where it is what is read.

A file that it writes over is named.
"""

import functools
import inspect
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any, get_args

import typer
from typer.models import ParameterInfo

from rigkit.common_options import common, name_of

JSON = "json"
"""Name of the option whose text is a file to write, or "-"."""


def written_file(metavar: str, text: str, *names: str) -> Any:
    """Declare an option that names a file to write: its help's words and, where they are not its parameter's, names."""
    return typer.Option(*names, metavar=metavar, dir_okay=False, writable=True, help=text)


def made_folder(metavar: str, text: str, *names: str) -> Any:
    """Declare an option that names a folder to fill, made with those above it."""
    return typer.Option(*names, metavar=metavar, file_okay=False, writable=True, help=text)


class Application(typer.Typer):
    """A command line whose commands refuse at once to write where that cannot be, or what they read."""

    def command(self, name: str | None = None, **options: Any) -> Callable[[Any], Any]:
        """Add a command, as `Typer.command` does."""
        add = super().command(name, **options)

        def added(function: Callable[..., Any]) -> Callable[..., Any]:
            add(_checked(function))
            return function

        return added


def _checked(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a command that looks at its paths before it does anything."""
    told = {name: _told(name, each) for name, each in inspect.signature(function, eval_str=True).parameters.items()}

    @functools.wraps(function)
    def command(version: bool = False, **given: Any) -> Any:  # noqa: ARG001 (read by its callback)
        paths = {name: (told[name], list(_paths(name, value))) for name, value in given.items()}
        _refuse(paths)
        files = [
            path for name, ((_, writes), its) in paths.items() if writes == "file" and name != JSON for path in its
        ]
        with _told_over(files):
            return function(**given)

    command.__signature__ = common(function)  # type: ignore[attr-defined]
    return command


@contextmanager
def _told_over(files: Iterable[Path]) -> Iterator[None]:
    """Say of which files the content is gone when the block ends; those that only have another name by then are not."""
    with ExitStack() as opened:
        there = [(path, opened.enter_context(path.open("rb"))) for path in files if path.is_file()]
        before = [os.fstat(file.fileno()).st_mtime_ns for _, file in there]
        try:
            yield
        finally:
            now = [os.fstat(file.fileno()) for _, file in there]
            is_gone = [each.st_nlink == 0 or each.st_mtime_ns != then for each, then in zip(now, before, strict=True)]
            say_over([path for (path, _), gone in zip(there, is_gone, strict=True) if gone])


def say_over(files: Sequence[Path]) -> None:
    """Say, on the standard error, which files were there already and have been written over."""
    if files:
        sys.stderr.write(f"written over: {files[0]}{f' and {len(files) - 1} more' * (len(files) > 1)}\n")


def _refuse(given: dict[str, tuple[tuple[str, str], list[Path]]]) -> None:
    """Refuse, by ValueError, paths that cannot be written, or that are given twice, once of them to be written."""
    seen = {path.resolve(): name for (name, writes), paths in given.values() if not writes for path in paths}
    for (name, writes), paths in given.values():
        for path in paths if writes else ():
            if fault := _unwritable(path, writes == "folder"):
                raise ValueError(f"{name} {path} {fault}")
            if writes == "file" and (other := seen.get(path.resolve())) is not None:
                raise ValueError(f"{name} {path} is {other}'s file, must be another: it would be written over")
            seen[path.resolve()] = name


def _told(name: str, parameter: inspect.Parameter) -> tuple[str, str]:
    """Return what a person calls a parameter, and whether it is a "file" or a "folder" to write, or "" to read."""
    info = next((each for each in get_args(parameter.annotation) if isinstance(each, ParameterInfo)), None)
    if name == JSON:
        return f"--{JSON}", "file"
    if info is None:
        return name, ""
    is_option = isinstance(info, typer.models.OptionInfo)
    shown = name_of(parameter, info) if is_option else str(info.metavar or name)
    return shown, ("folder" if info.dir_okay else "file") if info.writable else ""


def _paths(name: str, value: Any) -> Iterator[Path]:
    if name == JSON:
        yield from (Path(value),) if value not in (None, "-") else ()
    else:
        yield from (each for each in (value if isinstance(value, list) else [value]) if isinstance(each, Path))


def _unwritable(path: Path, is_folder: bool) -> str:
    """Say why a file cannot be written, or a folder made and written to; empty where it can."""
    if path.is_dir() != is_folder and path.exists():
        return f"is a {'file' if is_folder else 'folder'}, must be a {'folder' if is_folder else 'file'}"
    place = path if is_folder else path.parent
    while is_folder and not place.exists():
        place = place.parent
    if not place.is_dir():
        return f"cannot be: {place} is no folder"
    return "" if os.access(place, os.W_OK) else f"cannot be: nothing may be written in {place}"
