"""The command lines of a page: those in its fenced blocks, and those that begin the rows of its tables."""

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

PROGRAMS = ("vibractl", "stagectl", "calibrate", "firmware-sim")
_ROW = re.compile(r"\| `([^`]+)` ?\|")


@dataclass(frozen=True)
class Command:
    """A command line of this project's programs.

    Parameters
    ----------
    text : str
        As printed, without its comment.
    words : tuple of str
        The program and what it is given.
    into : str
        File that its output goes to; empty for none.
    in_background : bool
        Whether it ends in "&".
    """

    text: str
    words: tuple[str, ...]
    into: str
    in_background: bool


def commands(page: Path) -> list[Command]:
    """Return the commands of a page in order; what other programs are told to do is left out."""
    return [_command(line) for line in _lines(page.read_text()) if line.split(" ", 1)[0] in PROGRAMS]


def _lines(text: str) -> Iterator[str]:
    is_fenced, begun = False, ""
    for line in text.splitlines():
        if line.startswith("```"):
            is_fenced = not is_fenced
        elif not is_fenced:
            if row := _ROW.match(line):
                yield row.group(1)
        elif line.endswith("\\"):
            begun += line.removesuffix("\\").strip() + " "
        else:
            yield begun + line.strip()
            begun = ""


def _command(line: str) -> Command:
    words = shlex.split(line, comments=True)
    text = shlex.join(words).replace("'>'", ">").replace("'&'", "&")
    in_background = words[-1] == "&"
    words = words[:-1] if in_background else words
    into = words[-1] if len(words) > 1 and words[-2] == ">" else ""
    return Command(text, tuple(words[:-2] if into else words), into, in_background)
