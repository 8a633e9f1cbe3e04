"""The values of a rig file and of the settings laid over it, parsed and within bounds, before any model sees them."""

import math
import re
import tomllib
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from rigkit import os_fault
from rigkit.allowed import field_at
from rigkit.config_fault import LONGEST_VALUE, ConfigError, shown
from rigkit.nested import nodes
from rigkit.text_file import TextFault, read_text
from rigkit.toml_text import key_text

LARGEST_FILE = 1_000_000
"""Bytes; a complete rig file has a few thousand."""

DEEPEST_TABLE = 12
"""Tables and lists within each other."""

_LONG_KEY = re.compile(rf"""(?<![\w"'-])(?:(?:[\w-]+|"[^"\n]*"|'[^'\n]*')[ \t]*\.[ \t]*){{{DEEPEST_TABLE},}}""")


class Override:
    """One "table.key=value" given beside a rig file.

    Parameters
    ----------
    text : str
        The value is TOML; what is not TOML is text as it stands, and so is everything for a key that holds text.
    model : subclass of Section
        What a whole file holds.

    Raises
    ------
    ConfigError : there is no "=", or the key or a quoted or bracketed value is not TOML.
    """

    def __init__(self, text: str, model: type[BaseModel]) -> None:
        name, equals, value = text.partition("=")
        self.origin = f"--set {text if len(text) <= LONGEST_VALUE else text[:LONGEST_VALUE] + '...'}"
        if not (equals and text.isprintable()):
            raise ConfigError(f"--set {ascii(text)}: must be table.key=value on one line")
        self.path = self._path(name)
        self.value = self._value(value.strip(), model)
        _check(self.value, self.path, self.origin)

    def lay_over(self, data: dict[str, Any]) -> None:
        """Set the value in `data`, making the tables on the way."""
        for depth, name in enumerate(self.path[:-1], start=1):
            data = data.setdefault(name, {})
            if not isinstance(data, dict):
                raise ConfigError(f"{self.origin}: {key_text(*self.path[:depth])} is {shown(data)}, not a table")
        data[self.path[-1]] = self.value

    def _path(self, name: str) -> tuple[str, ...]:
        try:
            level: Any = _parsed(f"{name} = 0", self.origin)
        except ConfigError:
            raise ConfigError(f"{self.origin}: {name.strip()!r} is no key, must be such as table.key") from None
        path: list[str] = []
        while isinstance(level, dict):
            ((key, level),) = level.items()
            path.append(key)
        return tuple(path)

    def _value(self, text: str, model: type[BaseModel]) -> Any:
        field, _ = field_at(model, self.path)
        try:
            value = _parsed(f"value = {text}", self.origin)["value"]
        except ConfigError:
            if text.startswith(("[", "{", '"', "'")):
                raise
            return text
        return text if field is not None and field.annotation is str and not isinstance(value, str) else value


def file_values(path: str | Path) -> dict[str, Any]:
    """Read a TOML file: at most `LARGEST_FILE` bytes, UTF-8, tables nested at most `DEEPEST_TABLE` deep.

    Raises
    ------
    ConfigError : the file cannot be read or is no such TOML.
    """
    try:
        text = read_text(path, LARGEST_FILE)
    except OSError as fault:
        raise ConfigError(os_fault.told(fault)) from None
    except TextFault as fault:
        raise ConfigError(str(fault)) from None
    values = _parsed(text, str(path))
    _check(values, (), str(path))
    return values


def _check(values: Any, path: tuple[str, ...], origin: str) -> None:
    """Refuse what TOML can hold and a rig file cannot: inf, NaN, dates, and nesting beyond `DEEPEST_TABLE`."""
    for place, value in nodes(values, path):
        if len(place) > DEEPEST_TABLE:
            raise ConfigError(f"{origin}: {key_text(*place)} is nested more than {DEEPEST_TABLE} deep")
        match value:
            case dict() | list() | bool() | int() | str():
                pass
            case float() if not math.isfinite(value):
                raise ConfigError(f"{origin}: {key_text(*place)} is {value}, must be finite")
            case float():
                pass
            case _:
                raise ConfigError(f"{origin}: {key_text(*place)} is {value}, must be text, a number, true or false")


def _parsed(text: str, origin: str) -> dict[str, Any]:
    if _LONG_KEY.search(text):  # a key of n parts costs the parser n^2
        raise ConfigError(f"{origin}: a key of more than {DEEPEST_TABLE} parts")
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise ConfigError(f"{origin}: lists or tables nested more than {DEEPEST_TABLE} deep") from None
    except ValueError as fault:  # TOMLDecodeError, and a number of thousands of digits
        raise ConfigError(f"{origin}: not TOML: {fault}") from None
