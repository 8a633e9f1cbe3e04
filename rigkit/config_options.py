"""Options of code that a rig file names: those that are files, as the code's own signature says, are paths as others.

To see the signature the code is imported; so it is only where an option holds text.
"""

import inspect
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from rigkit.code_name import resolve
from rigkit.config_paths import Key, keys, value_at, whole

OPTIONS, SHORT = "options_of", "short_names"
"""In a key's schema: the keys that name the code whose options it holds; and where short names of code stand."""


@dataclass(frozen=True)
class OptionTable:
    """A key of a rig file that holds keywords of code.

    Parameters
    ----------
    key : tuple of str
        With its tables.
    code : tuple of (tuple of str, FieldInfo)
        The keys that name the code, whose keywords they are.
    """

    key: Key
    code: tuple[tuple[Key, FieldInfo], ...]


def option_tables(model: type[BaseModel]) -> Iterator[OptionTable]:
    """Yield the keys of a whole rig file that hold keywords of code."""
    fields = dict(keys(model))
    for key, field in fields.items():
        declared = field.json_schema_extra
        names: Any = declared.get(OPTIONS, ()) if isinstance(declared, dict) else ()
        code = [tuple(name.split(".")) if "." in name else (*key[:-1], name) for name in names]
        if code:
            yield OptionTable(key, tuple((each, fields[each]) for each in code))


def file_options(config: BaseModel) -> dict[Key, Any]:
    """Return the options that name files, by key, as a rig file has them."""
    values, found = config.model_dump(), dict[Key, Any]()
    for table in option_tables(type(config)):
        texts = {name: value for name, value in value_at(values, table.key).items() if _has_text(value)}
        for key, field in table.code if texts else ():
            files = _files(value_at(values, key), field)
            found |= {(*table.key, name): value for name, value in texts.items() if name in files}
    return found


def anchor_options(data: dict[str, Any], config: BaseModel, folder: Path, apart: Collection[Key]) -> bool:
    """Make relative paths among options whole, in place; return whether any was.

    Parameters
    ----------
    data : dict
        The values of a file, tables within each other.
    config : Section
        What came of them.
    folder : Path
        Of the file.
    apart : collection of tuple of str
        Keys that the file does not give.
    """
    found = False
    for key, value in file_options(config).items():
        anchored = whole(value, ("",), folder)
        if anchored != value and not any(key[: len(each)] == each for each in apart):
            value_at(data, key[:-1])[key[-1]], found = anchored, True
    return found


def _files(name: str, field: FieldInfo) -> set[str]:
    """Return the keywords of code that are files; none where there is no such code: using it says so better."""
    declared = field.json_schema_extra
    short = declared.get(SHORT) if isinstance(declared, dict) else None
    try:
        names = resolve(str(short)) if short else {}
        signature = inspect.signature(resolve(names.get(name, name)), eval_str=True)
    except Exception:  # whatever importing it does
        return set()
    return {each.name for each in signature.parameters.values() if _holds_path(each.annotation)}


def _holds_path(annotation: Any) -> bool:
    if isinstance(annotation, type) and issubclass(annotation, Path):
        return True
    return any(_holds_path(each) for each in get_args(annotation))


def _has_text(value: Any) -> bool:
    return isinstance(value, str) or (isinstance(value, list | tuple) and any(_has_text(each) for each in value))
