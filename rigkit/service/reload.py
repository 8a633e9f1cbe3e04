"""What an edit of a rig file touches, so that the least is done for it."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, Protocol, TypeVar

from pydantic import BaseModel

from rigkit.origin import flat
from rigkit.service.config import Daemon
from rigkit.toml_text import key_text, value_text

Model = TypeVar("Model", bound=BaseModel)


class Served(Protocol):
    """A rig file of a daemon."""

    @property
    def daemon(self) -> Daemon:
        """The daemon's own table."""

    def model_dump(self) -> dict[str, Any]:
        """Return all values."""


class Reach(IntEnum):
    """How deep an edit goes, the least first."""

    NOTHING = 0
    """No value has changed."""
    PARAMETERS = 1
    """Values that are taken over while a procedure goes on."""
    GRAPH = 2
    """What is built anew, aside, and taken when it may be."""
    DEVICES = 3
    """What has to be closed and opened again."""


@dataclass(frozen=True)
class Change:
    """An edit of a rig file.

    Parameters
    ----------
    keys : mapping of str to Reach
        Every key whose value has changed.
    done : str
        What was done for it and when it holds, in a sentence.
    """

    keys: Mapping[str, Reach]
    done: str = ""

    @property
    def reach(self) -> Reach:
        """The deepest of them."""
        return max(self.keys.values(), default=Reach.NOTHING)


def reloaded(old: Served, new: Served, reaches: Mapping[str, Reach], take: Callable[[Change], str]) -> Change:
    """Put an edited rig file in force; what is the daemon's own holds when that is started again.

    Parameters
    ----------
    old, new : Section
        Of one model.
    reaches : mapping of str to Reach
        As of `change`.
    take : callable(Change) -> str
        Does it, where anything has changed; says when what is the rig's holds, if something of it has changed.

    Raises
    ------
    ValueError : the data folder is another one; nothing has been done.
    """
    found = change(old, new, reaches)
    if found.reach is Reach.NOTHING:
        return found
    if new.daemon.data != old.daemon.data:
        raise ValueError("daemon.data cannot change while the daemon runs")
    rigs = {key: reach for key, reach in found.keys.items() if not key.startswith("daemon.")}
    parts = [take(Change(rigs)), "[daemon] when the daemon is started again" * (len(rigs) < len(found.keys))]
    return Change(found.keys, "; ".join(filter(None, parts)))


def edits(read: Served, in_force: Served, load: Callable[[], Served]) -> str:
    """Say how a rig file was edited since it was read, in a sentence; nothing where it was not.

    Parameters
    ----------
    read : Section
        What was read of it.
    in_force : Section
        What holds now, which a calibration may have changed: what the file says too is no difference.
    load : callable() -> Section
        Reads it.
    """
    way_out = "what was read before holds; a reload takes up the edit"
    try:
        now = load()
    except (ValueError, OSError) as fault:
        return f"the rig file was edited since it was read, and is wrong now: {fault}; {way_out}"
    found = change(read, now, {}).keys.keys() & change(in_force, now, {}).keys.keys()
    before, after = flat(in_force.model_dump()), flat(now.model_dump())
    told = [f"{key} {_shown(before.get(key))} -> {_shown(after.get(key))}" for key in sorted(found)]
    return f"the rig file was edited since it was read ({', '.join(told)}); {way_out}" if told else ""


def change(old: Served, new: Served, reaches: Mapping[str, Reach]) -> Change:
    """Compare two rig files.

    Parameters
    ----------
    old, new : Section
        Of one model.
    reaches : mapping of str to Reach
        How deep an edit of a table ("audio"), or of a key in it ("audio.attempts"), goes; the longer name counts.
        What is not named is GRAPH.
    """
    return Change({key: _reach(key, reaches) for key in _differing(old.model_dump(), new.model_dump(), ())})


def taken(old: Model, new: Model, keys: Iterable[str]) -> Model:
    """Return `old` with the values that `new` has for `keys`."""
    values, others = old.model_dump(), new.model_dump()
    for key in keys:
        *tables, name = key.split(".")
        into, out_of = values, others
        for table in tables:
            into, out_of = into[table], out_of[table]
        into[name] = out_of[name]
    return type(old).model_validate(values)


def _shown(value: Any) -> str:
    return "not there" if value is None else value_text(value)


def _differing(old: Mapping[str, Any], new: Mapping[str, Any], path: tuple[str, ...]) -> list[str]:
    found: list[str] = []
    for name in dict.fromkeys((*old, *new)):
        before, after = old.get(name), new.get(name)
        if isinstance(before, Mapping) and isinstance(after, Mapping):
            found += _differing(before, after, (*path, name))
        elif before != after or type(before) is not type(after):
            found.append(key_text(*path, name))
    return found


def _reach(key: str, reaches: Mapping[str, Reach]) -> Reach:
    parts = key.split(".")
    names = (".".join(parts[:length]) for length in range(len(parts), 0, -1))
    return next((reaches[name] for name in names if name in reaches), Reach.GRAPH)
