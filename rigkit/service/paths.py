"""Paths that come from outside: they stay within a folder, or are refused."""

from pathlib import Path


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
