"""Names of code in a rig file, "package.module:Name": what they lead to."""

import importlib
import importlib.util
from difflib import get_close_matches
from typing import Any

from rigkit.config_fault import ConfigError


def resolve(name: str) -> Any:
    """Return the object that "package.module:Name" names, importing its module.

    Raises
    ------
    ConfigError : the text has another form, the module is absent or cannot be imported, or it has no such name.
    """
    module_name, attribute = _parts(name)
    try:
        module = importlib.import_module(module_name)
    except ImportError as fault:
        if isinstance(fault, ModuleNotFoundError) and f"{module_name}.".startswith(f"{fault.name}."):
            raise ConfigError(f"{name}: there is no module {fault.name} on the Python path") from None
        raise ConfigError(f"{name}: module {module_name} cannot be imported: {fault}") from fault
    except OSError as fault:  # a module that loads a shared library of the system
        raise ConfigError(f"{name}: module {module_name} cannot be imported: {fault}") from fault
    if not hasattr(module, attribute):
        near = get_close_matches(attribute, dir(module), n=1)
        hint = f"; did you mean {near[0]}?" if near else ""
        raise ConfigError(f"{name}: module {module_name} has no {attribute}{hint}")
    return getattr(module, attribute)


def refuse_absent(name: str) -> None:
    """See that there is the module that "package.module:Name" names, without importing it.

    Raises
    ------
    ConfigError : the text has another form, or the module is absent.
    """
    module_name, _ = _parts(name)
    try:
        there = importlib.util.find_spec(module_name) is not None
    except ImportError:  # of a package above it
        there = False
    if not there:
        raise ConfigError(f"{name}: there is no module {module_name} on the Python path")


def _parts(name: str) -> tuple[str, str]:
    """Return the module and what is in it."""
    module_name, colon, attribute = name.partition(":")
    if not (colon and attribute.isidentifier() and all(part.isidentifier() for part in module_name.split("."))):
        raise ConfigError(f"{name!r} names nothing, must be package.module:Name")
    return module_name, attribute
