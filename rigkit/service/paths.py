"""Paths that come from outside: they stay within a folder, or are refused."""

import time
from collections.abc import Collection
from itertools import count
from pathlib import Path

RUNS = "runs"
"""The folder of runs, in the data folder."""


def run_path(data: str, name: str) -> Path:
    """Return where a run of that name belongs; one without a name has date and time for it.

    A clock that is set back, or has its winter time, shows a time twice: then the name has a number as well.

    Parameters
    ----------
    data : str
        The data folder.
    name : str
        Empty for none.
    """
    if name:
        return Path(data) / RUNS / name
    first = Path(data) / RUNS / time.strftime("%Y%m%d-%H%M%S")
    names = (first if number == 1 else first.with_name(f"{first.name}-{number}") for number in count(1))
    return next(path for path in names if not path.exists())


def data_file(data: str, option: str, name: str, words: Collection[str] = ()) -> Path:
    """Return the file in the data folder that an option of a procedure names.

    Parameters
    ----------
    data : str
        The data folder.
    option, name : str
        The option, and what it says.
    words : collection of str
        What else it may say, for the error.

    Raises
    ------
    ValueError : there is no such file in the data folder; the text names the option.
    """
    try:
        path = confined(Path(data), name)
    except PermissionError:
        path = None
    if path is None or not path.is_file():
        allowed = ", ".join([*words, f"{'or ' * bool(words)}a file in the data folder, {Path(data).absolute()}"])
        raise ValueError(f"{option} is {name[:80]!r}, must be {allowed}")
    return path


def confined(root: Path, text: str) -> Path:
    """Return the path that `text` names below `root`.

    Parameters
    ----------
    root : Path
    text : str
        Relative; no part of it begins with a dot.

    Raises
    ------
    PermissionError : it leads out of `root`, by its parts or through a link, or to what is hidden.

    Examples
    --------
    >>> confined(Path("/data/runs"), "monday/report.html")
    PosixPath('/data/runs/monday/report.html')
    """
    parts = text.split("/")
    if "\0" in text or "\\" in text or any(not part or part.startswith(".") for part in parts):
        raise PermissionError(f"{text[:80]!r} leads out of the data folder, or to what is hidden")
    path, inside = root.joinpath(*parts), root.resolve()
    if not path.resolve().is_relative_to(inside):
        raise PermissionError(f"{text[:80]!r} leads out of the data folder")
    return path
