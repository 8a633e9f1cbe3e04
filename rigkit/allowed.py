"""What a key of a rig file may hold, in words: for the comments of an example file and for errors."""

from collections.abc import Sequence
from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from rigkit.toml_text import value_text

_ONE = {bool: "true or false", int: "a whole number", float: "a number", str: "text", dict: "a table", Any: "any value"}
_MANY = {bool: "true or false", int: "whole numbers", float: "numbers", str: "texts"}
_COMPARISONS = (("ge", ">="), ("gt", ">"), ("le", "<="), ("lt", "<"))


def field_at(model: type[BaseModel], path: Sequence[str | int]) -> tuple[FieldInfo | None, tuple[str, ...]]:
    """Follow `path` through nested models to the key it ends in.

    Returns
    -------
    field : FieldInfo or None
        The declaration of the innermost key on the way that is no table of keys; None where there is no such key.
    way : tuple of str
        The part of `path` that leads to it, as far as it exists.
    """
    way: list[str] = []
    for name in path:
        field = model.model_fields.get(str(name))
        if field is None:
            break
        way.append(str(name))
        if not _is_table(field.annotation):
            return field, tuple(way)
        model = field.annotation  # type: ignore[assignment]  # a model, as just seen
    return None, tuple(way)


def model_at(model: type[BaseModel], path: Sequence[str]) -> type[BaseModel]:
    """Return the table of keys that `path` leads to; every name on it must be a table of the one before."""
    for name in path:
        model = model.model_fields[name].annotation  # type: ignore[assignment]  # the caller walked it with field_at
    return model


def kind(annotation: Any) -> str:
    """Say what type of value is wanted: "a whole number", "a list of 2 numbers", one of a few words."""
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is Literal:
        return " or ".join(value_text(choice) for choice in arguments)
    if origin is tuple:
        counted = "" if arguments[-1] is Ellipsis else f"{len(arguments)} "
        item, bounds = arguments[0], ""
        if get_origin(item) is Annotated:
            item, declared, *_ = get_args(item)
            bounds = f" {_bounds(declared)}"
        return f"a list of {counted}{_MANY.get(item, 'values')}{bounds}"
    if _is_table(annotation):
        return _ONE[dict]
    return _ONE.get(origin or annotation, str(annotation))


def limits(field: FieldInfo) -> str:
    """Say the range of a key and its unit, such as ">= 8000 and <= 192000 samples/s"; "" when there is neither."""
    return ", ".join(filter(None, (_range(field), *_form(field))))


def wanted(field: FieldInfo) -> str:
    """Say all that a key may hold, such as "a whole number >= 8000 and <= 192000 samples/s"."""
    return ", ".join((f"{kind(field.annotation)} {_range(field)}".strip(), *_form(field)))


def without_unit(field: FieldInfo) -> str:
    """Say all that a key may hold but its unit, such as "a whole number >= 8000 and <= 192000", for a page."""
    return ", ".join((f"{kind(field.annotation)} {_bounds(field)}".strip(), *_form(field, "`")))


def unit(field: FieldInfo) -> str:
    """Return the unit a key was declared with, "" for none and for a pure number."""
    name = declared_unit(field)
    return "" if name == "1" else name


def declared_unit(field: FieldInfo) -> str:
    """Return the unit a key was declared with, "1" for a pure number, "" for none."""
    declared = field.json_schema_extra
    return str(declared.get("unit", "")) if isinstance(declared, dict) else ""


def _is_table(annotation: Any) -> bool:
    return isinstance(annotation, type) and issubclass(annotation, BaseModel)


def _range(field: FieldInfo) -> str:
    bounds = _bounds(field)
    return f"{bounds or 'in'} {unit(field)}".strip() if bounds or unit(field) else ""


def _bounds(field: FieldInfo) -> str:
    limited = ((sign, _limit(field, name)) for name, sign in _COMPARISONS)
    return " and ".join(f"{sign} {_number(bound)}" for sign, bound in limited if bound is not None)


def _form(field: FieldInfo, quote: str = "") -> list[str]:
    parts = []
    if (shortest := _limit(field, "min_length")) is not None:
        parts.append("not empty" if shortest == 1 else f"at least {shortest} long")
    if (longest := _limit(field, "max_length")) is not None:
        parts.append(f"at most {longest} long")
    if (pattern := _limit(field, "pattern")) is not None:
        parts.append(f"matching {quote}{pattern}{quote}")
    return parts


def _limit(field: FieldInfo, name: str) -> Any:
    found = (getattr(limit, name, None) for limit in field.metadata)
    return next((bound for bound in found if bound is not None), None)


def _number(bound: Any) -> str:
    return f"{bound:g}" if isinstance(bound, float) else str(bound)
