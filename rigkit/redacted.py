"""Settings as others may see them: numbers and choices as they are, names, paths and addresses taken out."""

import getpass
import platform
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal, get_origin

from pydantic import BaseModel

from rigkit.allowed import field_at
from rigkit.config import CODE
from rigkit.config_text import dump_values
from rigkit.toml_text import key_text

_NUMBERS = re.compile(r"[a-z-]+(:-?\d+(\.\d*)?(e[+-]?\d+)?)*")
"""A word, or a word and numbers such as chirp:40:90:5."""
SHORTEST = 3
"""Characters of a private text that is looked for in other texts."""


class Redaction:
    """Takes private texts out of settings, and the same texts out of whatever is said beside them.

    A text stays that is a choice, names code, is the default of its key, or is a word and numbers such as
    chirp:40:90:5; all others become the key in angle brackets.  The user's name, the machine's and the home folder
    are taken out as well.
    """

    def __init__(self) -> None:
        self._hidden = {str(Path.home()): "<home>", platform.node(): "<machine>", _user(): "<user>"}

    def config(self, config: BaseModel) -> str:
        """Return settings as TOML without private texts, and remember those."""
        return dump_values(self._table(config.model_dump(), type(config), ()))

    def text(self, text: str) -> str:
        """Return a text without what has been hidden so far."""
        for private in sorted(self._hidden, key=len, reverse=True):
            if len(private) >= SHORTEST:
                text = re.sub(rf"(?<!\w){re.escape(private)}(?!\w)", self._hidden[private], text)
        return text

    def _table(self, values: Mapping[str, Any], model: type[BaseModel], path: tuple[str, ...]) -> dict[str, Any]:
        return {name: self._value(value, model, (*path, name)) for name, value in values.items()}

    def _value(self, value: Any, model: type[BaseModel], path: tuple[str, ...]) -> Any:
        if isinstance(value, Mapping):
            return self._table(value, model, path)
        if isinstance(value, list | tuple):
            return [self._value(each, model, path) for each in value]
        if not isinstance(value, str) or not value or self._is_public(value, model, path):
            return value
        self._hidden[value] = f"<{key_text(*path)}>"
        return self._hidden[value]

    def _is_public(self, value: str, model: type[BaseModel], path: tuple[str, ...]) -> bool:
        field, way = field_at(model, path)
        if field is None:
            return False
        declared = field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}
        is_default = way == path and (field.default == value or value in _several(field.default))
        return get_origin(field.annotation) is Literal or CODE in declared or is_default or _is_form(value)


def _is_form(value: str) -> bool:
    return ":" in value and _NUMBERS.fullmatch(value) is not None


def _several(default: Any) -> tuple[Any, ...]:
    return tuple(default) if isinstance(default, list | tuple) else ()


def _user() -> str:
    try:
        return getpass.getuser()
    except (OSError, KeyError, ImportError):  # a service without a name, or a system that does not tell
        return ""
