"""Paths in a rig file: relative ones are relative to that file, whatever folder a program works in."""

from collections.abc import Iterator, Sequence
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
            whole = _whole(value, suffixes(field), folder)
            if whole != value:
                place[name] = whole


def path_keys(model: type[BaseModel], above: Key = ()) -> Iterator[tuple[Key, FieldInfo]]:
    """Yield the keys that may hold paths, with their tables."""
    for name, field in model.model_fields.items():
        if isinstance(field.annotation, type) and issubclass(field.annotation, BaseModel):
            yield from path_keys(field.annotation, (*above, name))
        elif suffixes(field):
            yield (*above, name), field


def suffixes(field: FieldInfo) -> tuple[str, ...]:
    """Return the suffixes by which a key's text is a path; none where it never is."""
    declared = field.json_schema_extra
    found = declared.get(FILES, ()) if isinstance(declared, dict) else ()
    return tuple(found) if isinstance(found, tuple) else ()


def is_path(model: type[BaseModel], path: Sequence[str]) -> bool:
    """Whether a key may hold a path."""
    field, _ = field_at(model, path)
    return field is not None and bool(suffixes(field))


def _whole(value: Any, endings: tuple[str, ...], folder: Path) -> Any:
    if isinstance(value, list | tuple):
        return [_whole(each, endings, folder) for each in value]
    if not isinstance(value, str) or not value or "\0" in value:
        return value
    is_path = any(not ending or value.lower().endswith(ending) for ending in endings)
    return str(folder.absolute() / value) if is_path else value
