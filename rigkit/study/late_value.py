"""Values in a command line that an earlier command of the same task has written: `{drawn.json:rig.level}`."""

import re
from collections.abc import Sequence
from pathlib import Path

from rigkit.json_file import read_json
from rigkit.study.json_path import value_at
from rigkit.study.task import Words
from rigkit.toml_text import value_text

_LATE = re.compile(r"\{([\w.-]+\.json):([^{}]+)\}")


def with_late_values(words: Sequence[str], folder: Path) -> Words:
    """Return a command line with the values of JSON files in a folder in their places.

    Raises
    ------
    LookupError : a file has no such value.
    OSError, ValueError : a file is not there, or cannot be read.
    """
    return tuple(_LATE.sub(lambda found: _text(folder / found[1], found[2]), word) for word in words)


def _text(file: Path, path: str) -> str:
    try:
        value = value_at(read_json(file, object), path)
    except LookupError as fault:
        raise LookupError(f"{file.name}: {fault.args[0]}") from None
    return value if isinstance(value, str) else value_text(value)
