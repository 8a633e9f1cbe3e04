"""The reference page of a rig file, made from its models: every key with meaning, unit, range and default.

`python -m rigkit.config_reference MODULE:MODEL FILE` prints it.
"""

import inspect
import sys
from collections.abc import Iterator, Mapping

from pydantic import BaseModel

from rigkit.allowed import declared_unit, without_unit
from rigkit.code_name import resolve
from rigkit.toml_text import key_text, value_text

_HEAD = ("key", "meaning", "unit", "allowed", "default")


def reference(model: type[BaseModel], name: str) -> str:
    """Write the page: a table of keys for every table of a rig file.

    Parameters
    ----------
    model : subclass of Section
        With a default for every key that has one.
    name : str
        What such a file is called.
    """
    return "\n".join([f"# Every key of `{name}`", "", _INTRODUCTION, *_tables(model.model_construct(), ()), ""])


_INTRODUCTION = """\
Written by `make docs` from the models that read the file: what stands here is what is checked. An unknown key, a value
of another type or out of its range, inf and NaN are refused, in one line that names the key, the value and what is
allowed. A key that is left out has its default; `--set table.key=value` sets one over the file. Keys that must also fit
each other are compared when all are read. Unit 1 is a pure number."""


def _tables(values: BaseModel, path: tuple[str, ...]) -> Iterator[str]:
    named = [(name, getattr(values, name), field) for name, field in type(values).model_fields.items()]
    plain = [(name, value, field) for name, value, field in named if not isinstance(value, BaseModel)]
    if path:
        purpose = (inspect.getdoc(type(values)) or "").split("\n\n")[0]
        yield from ("", f"## `[{key_text(*path)}]`", " ".join(purpose.split()))
    if plain:
        yield from ("", _row(_HEAD), _row(["---"] * len(_HEAD)))
    for name, value, field in plain:
        default = f"`{value_text(value)}`" if value or not isinstance(value, Mapping) else "empty"
        yield _row((f"`{key_text(name)}`", field.description or "", declared_unit(field), without_unit(field), default))
    for name, value, _ in named:
        if isinstance(value, BaseModel):
            yield from _tables(value, (*path, name))


def _row(cells: Iterator[str] | list[str] | tuple[str, ...]) -> str:
    return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"


if __name__ == "__main__":
    sys.stdout.write(reference(resolve(sys.argv[1]), sys.argv[2]))
