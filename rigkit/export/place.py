"""Where exported files go: a folder, or one file for one format."""

from collections.abc import Collection
from pathlib import Path
from typing import Annotated

import typer

OutOption = Annotated[Path | None, typer.Option("--out", metavar="DIR", help="Folder to make; else RUN/export.")]
FileOption = Annotated[
    Path | None, typer.Option("--file", metavar="FILE", help="One file in place of a folder, for one format.")
]


def place_of(out: Path | None, file: Path | None, suffixes: Collection[str]) -> Path | None:
    """Return where files go, as --out or --file says; --out with a suffix of a file is read as --file.

    Raises
    ------
    ValueError : both are given, or a file whose suffix is none of `suffixes`.
    """
    if out is not None and file is not None:
        raise ValueError(f"--out {out} and --file {file} are given, must be one of them")
    if file is not None and file.suffix.lower() not in suffixes:
        raise ValueError(f"--file is {file}, must end in {', '.join(suffixes)}")
    return file or out
