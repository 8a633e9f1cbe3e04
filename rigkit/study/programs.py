"""The programs that a study may run, in this process: those which this distribution installs."""

import sys
from collections.abc import Callable, Sequence
from importlib.metadata import distribution
from typing import Any

_GROUP = "console_scripts"


def names() -> tuple[str, ...]:
    """Return the names of all."""
    return tuple(sorted(_points()))


def call(words: Sequence[str]) -> int:
    """Run a command line as its program does, and return its exit status.

    Raises
    ------
    LookupError : there is no such program.
    Exception : as the program raises it.
    """
    main: Callable[[], int] = _points()[words[0]].load()
    before = sys.argv
    sys.argv = list(words)
    try:
        return main()
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 1 if end.code else 0
    finally:
        sys.argv = before


def _points() -> dict[str, Any]:
    points = distribution("vibrostage").entry_points
    return {point.name: point for point in points if point.group == _GROUP}
