"""The command lines of a page: those in its fenced or indented blocks, and those that begin the rows of its tables."""

import re
import shlex
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

PROGRAMS = ("vibractl", "stagectl", "calibrate", "firmware-sim", "vibrostage")
TOOLS = ("awk", "cp")
"""Programs of others that make a file for them."""
_BEGINNINGS = tuple(f"{program} " for program in (*PROGRAMS, *TOOLS))
_INDENTED = "    "
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
    """Return the commands of a page in order, those of its tables as well; those of other programs are left out."""
    return _commands(line for _, line in _lines(page.read_text()))


def block_commands(page: Path) -> list[Command]:
    """Return the commands of a page's blocks in order; a table's rows may be about commands, and none to be given."""
    return _commands(line for is_row, line in _lines(page.read_text()) if not is_row)


def _commands(lines: Iterable[str]) -> list[Command]:
    return [command_of(line) for line in lines if line.startswith(_BEGINNINGS)]


def _lines(text: str) -> Iterator[tuple[bool, str]]:
    """Go through the lines that may be commands, and whether each begins a table's row."""
    is_fenced, begun = False, ""
    for line in text.splitlines():
        if line.startswith("```"):
            is_fenced = not is_fenced
        elif not is_fenced:
            if row := _ROW.match(line):
                yield True, row.group(1)
            elif line.startswith(_INDENTED):
                yield False, line.strip()
        elif line.endswith("\\"):
            begun += line.removesuffix("\\").strip() + " "
        else:
            yield False, begun + line.strip()
            begun = ""


def command_of(line: str) -> Command:
    """Read a command line as a shell does."""
    words = shlex.split(line, comments=True)
    text = shlex.join(words).replace("'>'", ">").replace("'&'", "&")
    in_background = words[-1] == "&"
    words = words[:-1] if in_background else words
    into = words[-1] if len(words) > 1 and words[-2] == ">" else ""
    return Command(text, tuple(words[:-2] if into else words), into, in_background)
