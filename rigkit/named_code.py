"""Code that a rig file names as package.module:Class: looked at before it is called, and before a daemon imports it.

A rig file is code: importing a module runs it.  So whoever starts a program with a rig file must trust it; but a file
that a daemon is led to later, over the network or by a reload, may name only what the daemon was started with.
"""

import inspect
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from pydantic import BaseModel

from ctlblocks import Block
from rigkit.code_name import resolve
from rigkit.config import CODE, ConfigError


def named_class(name: str, what: str, fits: Callable[[type], bool], *makers: object) -> Any:
    """Return the class that a rig file names, or one of the functions that make one; nothing of it is called.

    Parameters
    ----------
    name : str
        "package.module:Class".
    what : str
        What it must be, for the error: "the class of a Block".
    fits : callable(type) -> bool
        Whether the class is one of these.
    *makers : functions
        That stand for such a class.

    Raises
    ------
    ConfigError : there is none of that name, or it is something else.
    """
    found = resolve(name)
    if any(found is maker for maker in makers):
        return found
    if not isinstance(found, type):
        raise ConfigError(f"{name} is a {type(found).__name__}, must be {what}")
    if not fits(found):
        raise ConfigError(f"{name} is another class, must be {what}")
    return found


def named_block(name: str, options: Mapping[str, object]) -> Block:
    """Build a Block.

    Parameters
    ----------
    name : str
        "package.module:Class".
    options : mapping of str to object
        Its keywords.

    Raises
    ------
    ConfigError : there is none of that name, it is no Block, or it does not take these options.
    ValueError : it refuses one.
    """
    build = named_class(name, "the class of a Block", lambda found: issubclass(found, Block))
    try:
        inspect.signature(build).bind(**options)
    except TypeError as fault:
        known = ", ".join(inspect.signature(build).parameters) or "none"
        wrong = str(fault).replace("missing a required argument:", "it needs")
        raise ConfigError(f"{name} does not take these options: {wrong}; there are {known}") from None
    made: Block = build(**options)
    return made


def names_in(config: BaseModel) -> dict[str, str]:
    """Return the code that settings name, by key; keys that name none are left out."""
    return dict(_names(config, ""))


class KnownCode:
    """The code that a daemon may import: what it was started with.

    Parameters
    ----------
    *configs : Section
        What they name and what their defaults do.
    """

    def __init__(self, *configs: BaseModel) -> None:
        each = [whole for config in configs for whole in (config, type(config)())]
        self.names = frozenset(name for whole in each for name in names_in(whole).values())

    def has_all_of(self, config: BaseModel) -> bool:
        """Whether settings name no other code."""
        return self.names.issuperset(names_in(config).values())

    def refuse_other(self, config: BaseModel) -> None:
        """Refuse settings that name other code, before any of it is imported.

        Raises
        ------
        ConfigError : the first key that does.
        """
        known = ", ".join(sorted(self.names))
        for key, name in names_in(config).items():
            if name not in self.names:
                raise ConfigError(
                    f"{key} is {name!r}, must be code that the daemon was started with: {known}; to use another, name "
                    "it in the daemon's rig file and start the daemon again"
                )


def _names(config: BaseModel, prefix: str) -> Iterator[tuple[str, str]]:
    for key, field in type(config).model_fields.items():
        value = getattr(config, key)
        if isinstance(value, BaseModel):
            yield from _names(value, f"{prefix}{key}.")
        elif isinstance(field.json_schema_extra, dict) and field.json_schema_extra.get(CODE) and ":" in value:
            yield f"{prefix}{key}", str(value)
