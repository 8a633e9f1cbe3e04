"""What is wrong with a rig file, in one line: the key, its value, what is allowed."""

import json
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from rigkit.allowed import field_at, limits, model_at, wanted
from rigkit.config_paths import keys
from rigkit.toml_text import key_text, value_text

Model = TypeVar("Model", bound=BaseModel)

LONGEST_VALUE = 60
"""Characters of a value that an error shows."""
MOST_NAMED = 3
"""Keys of other tables that an error names."""

_RANGE_FAULTS = {"greater_than", "greater_than_equal", "less_than", "less_than_equal"}


OTHERS = 10
"""Things wrong, from which on a file is more likely that of another program than mistyped."""


class ConfigError(ValueError):
    """A rig file, or a setting given beside it, that cannot be used; the text is one line."""


def explained(
    fault: ValidationError, model: type[BaseModel], data: Mapping[str, Any], whole: str = "a rig file"
) -> tuple[tuple[str, ...], str]:
    """Say the first of the things wrong with `data`, and how many more there are; `whole` is what `data` is of.

    Returns
    -------
    path : tuple of str
        The key that is wrong; empty when several keys do not go together.
    text : str
    """
    faults = fault.errors(include_url=False)
    path, text = _explained(faults[0], model, data, whole)
    if len(faults) == 1:
        return path, text
    other = ": is it the file of another program?" if len(faults) > OTHERS else ""
    return path, f"{text} (and {len(faults) - 1} more{other})"


def checked(model: type[Model], given: Mapping[str, Any], whole: str) -> Model:
    """Make a section from what was given by its keys; `whole` is what they are of.

    Raises
    ------
    ConfigError : the first thing that is wrong with it.
    """
    try:
        return model(**given)
    except ValidationError as fault:
        raise ConfigError(explained(fault, model, given, whole)[1]) from None


def shown(value: Any) -> str:
    """Write a value as in the file, or as in JSON if none of a file's, shortened where it is long."""
    try:
        text = value_text(value)
    except (TypeError, ValueError):
        text = json.dumps(value)
    return text if len(text) <= LONGEST_VALUE else f"{text[:LONGEST_VALUE]}..."


def _explained(
    fault: ErrorDetails, model: type[BaseModel], data: Mapping[str, Any], whole: str
) -> tuple[tuple[str, ...], str]:
    location = fault["loc"]
    field, way = field_at(model, location)
    reason = fault.get("ctx", {}).get("error")
    if field is None and fault["type"] == "extra_forbidden":
        path = (*way, str(location[len(way)]))
        return path, _unknown(path, model, data, whole)
    if field is None and reason is not None:
        return way, str(reason)
    value = f"{key_text(*way)} is {shown(_value(data, way))}"
    if reason is not None:
        return way, f"{value}: {reason}"
    if field is None:
        return way, f"{value}, must be a table"
    if fault["type"] in _RANGE_FAULTS:
        return way, f"{value}, must be {limits(field)}"
    meaning = f" ({field.description})" if fault["type"] == "string_pattern_mismatch" else ""
    return way, f"{value}, must be {wanted(field)}{meaning}"


def _unknown(path: Sequence[str], model: type[BaseModel], data: Mapping[str, Any], whole: str) -> str:
    """Say that there is no such key, and which may have been meant: one of its table, or its name in another one."""
    *parents, name = path
    where = f"[{key_text(*parents)}]" if parents else whole
    its = list(model_at(model, parents).model_fields)
    elsewhere = [key_text(*key) for key, _ in keys(model) if key[-1] == name]
    near = get_close_matches(name, its, n=1) or elsewhere[:MOST_NAMED]
    hint = f"did you mean {' or '.join(near)}?" if near else f"there are {', '.join(its)}"
    return f"{key_text(*path)} is {shown(_value(data, path))}, but {where} has no {name}; {hint}"


def _value(data: Mapping[str, Any], path: Sequence[str]) -> Any:
    value: Any = data
    for name in path:
        value = value[name]
    return value
