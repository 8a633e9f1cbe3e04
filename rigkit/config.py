"""Rig files: TOML read into strict models whose every key has a unit, a range and a default."""

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, ClassVar, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from rigkit.config_fault import ConfigError, explained
from rigkit.config_options import OPTIONS, SHORT, anchor_options
from rigkit.config_paths import FILES, anchored
from rigkit.config_role import ROLE, Role
from rigkit.config_source import Override, file_values
from rigkit.config_text import dump, example

__all__ = ["ConfigError", "Section", "code", "dump", "example", "keywords", "load", "setting"]

CODE = "code"
"""Marks, in the schema of a key, that it names code."""
CLASS = r"^[\w.]+:\w+$"


class Section(BaseModel):
    """A table of a rig file.  Unknown keys, inf, NaN and a bool for a number are refused."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False, validate_default=True)
    role: ClassVar[Role] = "experiment"
    """Of its keys that declare none."""


Model = TypeVar("Model", bound=Section)


def setting(
    default: Any, unit: str, text: str, role: Role | None = None, files: tuple[str, ...] = (), **limits: Any
) -> Any:
    """Declare one key of a `Section`: its default, its unit ("" for none), what it is for and its limits.

    `role` is its table's where none is given; `files` are the suffixes by which its text is a path, ("",) where it
    always is one; `limits` are pydantic's own (`ge`, `gt`, `le`, `lt`, `min_length`,
    `max_length`, `pattern`).
    """
    declared: dict[str, Any] = {"unit": unit}
    declared |= {} if role is None else {ROLE: role}
    declared |= {FILES: files} if files else {}
    return Field(default=default, description=text, json_schema_extra=declared, **limits)


def code(
    default: str, text: str, pattern: str | None = CLASS, role: Role | None = None, short: str | None = None
) -> Any:
    """Declare one key of a `Section` that names code as "package.module:Class": its default and what it is for.

    `pattern` is of what else it may be, None if that is anything; `role` as for `setting`; `short` names, as code, a
    table from short names to such as this.
    """
    made = setting(default, "", text, role, pattern=pattern)
    made.json_schema_extra |= {CODE: True} | ({} if short is None else {SHORT: short})
    return made


def keywords(text: str, *of: str) -> Any:
    """Declare one key of a `Section` that holds keywords of code: what they are for, and the keys that name the code.

    A key of the same table by its name, another by its whole key, such as plants.robot.
    """
    made = setting({}, "", text)
    made.json_schema_extra[OPTIONS] = of
    return made


def load(
    path: str | Path | None,
    model: type[Model],
    overrides: Sequence[str] = (),
    as_written: bool = False,
    trusts: Callable[[Model], bool] = lambda _: True,
    gone: Sequence[str] = (),
) -> Model:
    """Read a rig file, lay the overrides over it and check the whole.

    Relative paths in the file are relative to it; those in overrides are relative to where the program works.

    Parameters
    ----------
    path : str, Path or None
        The file, TOML in UTF-8; None for the defaults.
    model : subclass of Section
        What a whole file holds.
    overrides : sequence of str, "table.key=value"
        The value is TOML; a bare word is text.  They go one level deep or many ("simulator.options.noise=-80").
    as_written : bool
        Leave relative paths as they are.
    trusts : callable(Section) -> bool
        Whether code that the file names may be imported, to see which of its options are paths.
    gone : sequence of str, "table.key"
        Keys that the file of a run of before may have, and that are passed over.

    Raises
    ------
    ConfigError : one line with the file (or the override), the key, the value and what is allowed.
    """
    data = {} if path is None else file_values(path)
    for table, _, key in (each.partition(".") for each in gone):
        data.get(table, {}).pop(key, None)
    if path is not None and not as_written:
        anchored(data, model, Path(path).parent)
    parsed = [Override(text, model) for text in overrides]
    for override in parsed:
        override.lay_over(data)
    made = _checked(data, model, path, parsed)
    if path is None or as_written or not trusts(made):
        return made
    is_other = anchor_options(data, made, Path(path).parent, [override.path for override in parsed])
    return _checked(data, model, path, parsed) if is_other else made


def _checked(data: dict[str, Any], model: type[Model], path: str | Path | None, overrides: Sequence[Override]) -> Model:
    try:
        # Through JSON, since there strict means strict about values and not about list or tuple, 3 or 3.0.
        return model.model_validate_json(json.dumps(data))
    except ValidationError as fault:
        where, text = explained(fault, model, data)
        raise ConfigError(f"{_origin(where, path, overrides)}{text}") from None


def _origin(where: tuple[str, ...], path: str | Path | None, overrides: Sequence[Override]) -> str:
    """Say where the value of key or table `where` came from; of a table, each source that had a part in it."""
    setting_it = [override.origin for override in overrides if where[: len(override.path)] == override.path]
    if setting_it:
        return f"{setting_it[-1]}: "
    within = [override.origin for override in overrides if override.path[: len(where)] == where]
    sources = [*([str(path)] if path is not None else []), *within]
    return f"{' '.join(sources)}: " if sources else ""
