"""Paths in a rig file: relative ones are relative to that file, whatever folder a program works in."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from rigkit.allowed import field_at

FILES = "files"
"""In a key's schema: the suffixes by which its text is that of a file; "" where it always is."""
Key = tuple[str, ...]


def anchored(data: dict[str, Any], model: type[BaseModel], folder: Path) -> None:
    """Make the relative paths in a file's values whole, in place; those that are left to their defaults as well.

    Parameters
    ----------
    data : dict
        The values of a file, tables within each other; of any types.
    model : subclass of Section
        What a whole file holds.
    folder : Path
        Of the file.
    """
    for key, field in path_keys(model):
        *tables, name = key
        place: Any = data
        for table in tables:
            place = place.setdefault(table, {}) if isinstance(place, dict) else None
        if isinstance(place, dict):
            value = place.get(name, field.default)
            found = whole(value, suffixes(field), folder)
            if found != value:
                place[name] = found


def path_keys(model: type[BaseModel]) -> Iterator[tuple[Key, FieldInfo]]:
    """Yield the keys that may hold paths, with their tables."""
    return ((key, field) for key, field in keys(model) if suffixes(field))


def keys(model: type[BaseModel], above: Key = ()) -> Iterator[tuple[Key, FieldInfo]]:
    """Yield all keys, with their tables."""
    for name, field in model.model_fields.items():
        if isinstance(field.annotation, type) and issubclass(field.annotation, BaseModel):
            yield from keys(field.annotation, (*above, name))
        else:
            yield (*above, name), field


def value_at(values: Any, key: Key) -> Any:
    """Return the value of a key, of tables within each other."""
    for name in key:
        values = values[name]
    return values


def suffixes(field: FieldInfo) -> tuple[str, ...]:
    """Return the suffixes by which a key's text is a path; none where it never is."""
    declared = field.json_schema_extra
    found = declared.get(FILES, ()) if isinstance(declared, dict) else ()
    return tuple(found) if isinstance(found, tuple) else ()


def is_path(model: type[BaseModel], path: Sequence[str]) -> bool:
    """Whether a key may hold a path."""
    field, _ = field_at(model, path)
    return field is not None and bool(suffixes(field))


def whole(value: Any, endings: tuple[str, ...], folder: Path) -> Any:
    """Return a path, or each of a list, as it is from a folder; what is none stays as it is."""
    return each_path(value, endings, lambda text: str(folder.absolute() / text))


def each_path(value: Any, endings: tuple[str, ...], change: Callable[[str], str]) -> Any:
    """Return a path, or each of a list, changed; what is none of text, or ends otherwise, stays as it is."""
    if isinstance(value, list | tuple):
        return [each_path(each, endings, change) for each in value]
    return change(value) if _is_path(value, endings) else value


def paths_of(value: Any, endings: tuple[str, ...]) -> list[Path]:
    """Return the paths that a value holds: itself, or each of a list."""
    if isinstance(value, list | tuple):
        return [path for each in value for path in paths_of(each, endings)]
    return [Path(value)] if _is_path(value, endings) else []


def _is_path(value: Any, endings: tuple[str, ...]) -> bool:
    if not isinstance(value, str) or not value or "\0" in value:
        return False
    return any(not ending or value.lower().endswith(ending) for ending in endings)
