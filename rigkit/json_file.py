"""JSON that a person or another program may have written: read as what it says, or refused by a line that says why."""

import json
import math
import os
from collections import Counter
from typing import Any, TypeVar

from rigkit.nested import Path, nodes
from rigkit.text_file import TextFault, read_text

LARGEST_FILE = 50_000_000
"""Bytes: a path of a million segments has half of it."""
DEEPEST = 12
"""Objects and lists within each other."""
_NAMES = {dict: "an object", list: "a list", str: "text", bool: "true or false", int: "a number", float: "a number"}

Value = TypeVar("Value")


class JsonError(ValueError):
    """JSON that cannot be used; the text is one line that names the file and what is wrong with it."""


def read_json(path: str | os.PathLike[str], expected: type[Value]) -> Value:
    """Read a JSON file.

    Parameters
    ----------
    path : path
    expected : dict or list
        What it holds as a whole.

    Raises
    ------
    JsonError : not UTF-8, more than `LARGEST_FILE` bytes, or what `json_value` refuses.
    OSError : it cannot be read.
    """
    try:
        text = read_text(path, LARGEST_FILE)
    except TextFault as fault:
        raise JsonError(str(fault)) from None
    return json_value(text, str(path), expected)


def json_value(text: str, origin: str, expected: type[Value]) -> Value:
    """Read JSON, and refuse what other programs would read as something else, or fail at.

    Parameters
    ----------
    text : str
    origin : str
        Where it comes from: begins the text of an error.
    expected : dict, list, or object for anything

    Raises
    ------
    JsonError : no JSON, or another value as a whole; nesting beyond `DEEPEST`; NaN, an infinity or an integer beyond 64
        bits; a key that is there twice; half a character.
    """
    try:
        value = json.loads(text, object_pairs_hook=_object)
    except RecursionError:
        raise JsonError(f"{origin}: objects or lists nested more than {DEEPEST} deep") from None
    except json.JSONDecodeError as fault:
        raise JsonError(f"{origin}: not JSON: {fault}") from None
    except ValueError as fault:  # a key twice, or a number of thousands of digits
        raise JsonError(f"{origin}: {str(fault).partition(';')[0]}") from None
    for path, each in nodes(value):
        if wrong := _wrong(path, each):
            raise JsonError(f"{origin}: {wrong}")
    if not isinstance(value, expected):
        found = "null" if value is None else _NAMES[type(value)]
        raise JsonError(f"{origin}: is {found}, must be {_NAMES[expected]}")
    return value


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    made = dict(pairs)
    if len(made) < len(pairs):
        counts = Counter(key for key, _ in pairs)
        twice = next(key for key, times in counts.items() if times > 1)
        raise ValueError(f"the key {_shown(twice)} is there twice")
    return made


def _wrong(path: Path, value: Any) -> str:
    """Say what is wrong with one value or the key to it; nothing where it is sound."""
    if len(path) > DEEPEST:
        return f"objects or lists nested more than {DEEPEST} deep"
    if path and not _is_whole(path[-1]):
        return f"the key {_shown(path[-1])} holds half a character, an unpaired surrogate"
    match value:
        case str() if not _is_whole(value):
            wrong = "holds half a character, an unpaired surrogate"
        case float() if not math.isfinite(value):
            wrong = "must be finite"
        case int() if not -(2**63) <= value < 2**63:
            wrong = "must be within 64 bits"
        case _:
            return ""
    return f"{'.'.join(path)[:60] or 'it'} is {_shown(value)}, {wrong}"


def _is_whole(text: str) -> bool:
    return text.isascii() or not any("\ud800" <= letter <= "\udfff" for letter in text)


def _shown(value: str | float) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else f"{text[:60]}..."
