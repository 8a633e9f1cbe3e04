"""A rig file's text, from a model: a complete example with every key explained, or the values of a run."""

import inspect
import textwrap
from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from rigkit.allowed import kind, limits
from rigkit.toml_text import key_text, value_text

WIDTH = 120
"""Columns of an example file."""

_NARROWEST_COMMENT = 60

_TIED = "\0"
"""Stands for a space at which no comment is broken; TOML has no such character."""


def dump(config: BaseModel) -> str:
    """Write the values of a configuration as TOML; `load` gives an equal one, every number to its last bit."""
    return dump_values(config.model_dump())


def dump_values(values: Mapping[str, Any]) -> str:
    """Write values as TOML, tables within each other."""
    lines: list[str] = []
    for path, table in _tables(values, ()):
        lines += [f"[{key_text(*path)}]"] if path else []
        lines += [f"{key_text(name)} = {value_text(value)}" for name, value in table.items()]
        lines += [""]
    return "\n".join(lines).lstrip()


def example(model: type[BaseModel]) -> str:
    """Write a complete rig file: every key at its default, and after it what it is, its unit, range and default.

    `model` must have a default for every key.
    """
    heading = "# Every key at its default.  Behind it: what it is; range and unit, or type; the default."
    return "\n".join([heading, *_explained(model(), ()), ""])


def _tables(table: Mapping[str, Any], path: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], dict[str, Any]]]:
    plain = {name: value for name, value in table.items() if not isinstance(value, Mapping)}
    if plain or (path and not table):
        yield path, plain
    for name, value in table.items():
        if isinstance(value, Mapping):
            yield from _tables(value, (*path, name))


def _explained(values: BaseModel, path: tuple[str, ...]) -> Iterator[str]:
    if path:
        yield ""
        purpose = " ".join((inspect.getdoc(type(values)) or "").split("\n\n")[0].split())
        yield from textwrap.wrap(purpose, WIDTH, initial_indent="# ", subsequent_indent="# ")
        yield f"[{key_text(*path)}]"
    named = [(name, getattr(values, name), field) for name, field in type(values).model_fields.items()]
    plain = [(name, value, field) for name, value, field in named if not isinstance(value, BaseModel | Mapping)]
    longest = max((len(name) for name, _, _ in plain), default=0)
    lines = [f"{key_text(name):{longest}} = {value_text(value)}" for name, value, _ in plain]
    column = min(max(map(len, lines), default=0) + 2, WIDTH - _NARROWEST_COMMENT)
    for line, (_, value, field) in zip(lines, plain, strict=True):
        yield from _beside(line, column, _comment(field, value))
    for name, value, field in named:
        if isinstance(value, BaseModel):
            yield from _explained(value, (*path, name))
        elif isinstance(value, Mapping):
            yield ""
            yield from textwrap.wrap(f"{field.description}; a table of any keys", WIDTH, initial_indent="# ")
            yield f"[{key_text(*path, name)}]"
            yield from (f"{key_text(key)} = {value_text(item)}" for key, item in value.items())


def _comment(field: FieldInfo, value: Any) -> str:
    default = f"default {value_text(value)}".replace(" ", _TIED)
    return f"{field.description}; {limits(field) or kind(field.annotation)}; {default}"


def _beside(line: str, column: int, comment: str) -> Iterator[str]:
    lines = textwrap.wrap(comment, WIDTH - column - 2, break_long_words=False, break_on_hyphens=False)
    first, *others = [text.replace(_TIED, " ") for text in lines]
    if len(line) + 2 > column:
        yield line
        line = ""
    yield f"{line:{column}}# {first}"
    yield from (f"{'':{column}}# {other}" for other in others)
