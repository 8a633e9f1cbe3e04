"""TOML text of plain values: text, numbers, true and false, lists and tables."""

import json
import math
import re
from collections.abc import Mapping
from typing import Any

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


def value_text(value: Any) -> str:
    """Write one value on one line; `tomllib` reads the same value back, a float to its last bit.

    Raises
    ------
    TypeError : the value is of a type that has no place in a rig file.
    ValueError : a number is not finite.
    """
    match value:
        case bool():
            return "true" if value else "false"
        case float() if not math.isfinite(value):
            raise ValueError(f"a setting is {value}, must be finite")
        case int() | float():
            return repr(value)
        case str():
            return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
        case list() | tuple():
            return f"[{', '.join(value_text(item) for item in value)}]"
        case Mapping():
            pairs = (f"{key_text(key)} = {value_text(item)}" for key, item in value.items())
            return f"{{{', '.join(pairs)}}}"
    raise TypeError(f"a setting is {value!r}, must be text, a number, true, false, a list or a table")


def key_text(*names: str) -> str:
    """Write the dotted key of nested `names`, quoted where TOML wants it."""
    return ".".join(name if _BARE_KEY.fullmatch(name) else value_text(name) for name in names)
