"""Whether two things were made of the same: one comparison, with three verdicts, for everything that asks.

Same; different without harm, which is said; different so that one would spoil the other, which is refused until it is
accepted by its key.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePath
from typing import Annotated, Any

import typer
from pydantic import BaseModel

from rigkit.config_files import sums_of
from rigkit.config_options import file_options
from rigkit.config_paths import is_path
from rigkit.config_role import Role, is_free, role_at
from rigkit.origin import Origin, flat
from rigkit.toml_text import value_text

DRIVE = "drive"
"""Key of a drive that is not the one that was played."""
CHANNELS = "channels"
"""Key of channels that are not those of a model: known when the rig has answered, and said then."""
CONTENT = ", its content,"
MOST_SAID = 4
_IDLE = ": nothing differs there"

AcceptOption = Annotated[
    list[str] | None,
    typer.Option("--accept", metavar="KEY", help="Accept this difference; may be repeated."),
]


class DisagreementError(ValueError):
    """What differs would spoil it; the text names keys, values and ways out."""


@dataclass(frozen=True)
class Use:
    """What a thing is compared for, and so which differences do harm.

    Parameters
    ----------
    harmful : set of Role
        Keys with these roles must be the same.
    said : set of Role
        Keys with these may differ, but it is said; others are not compared.
    apart : tuple of str
        Tables that the thing does not depend on.
    """

    harmful: frozenset[Role]
    said: frozenset[Role]
    apart: tuple[str, ...] = ()

    def without(self, *tables: str) -> "Use":
        """Return it for a thing that does not depend on some tables."""
        return Use(self.harmful, self.said, (*self.apart, *tables))

    def concerns(self, key: str, role: Role) -> bool:
        """Whether a difference in a key would be told at all."""
        is_apart = any(key == table or key.startswith(f"{table}.") for table in self.apart)
        return not is_apart and role in self.harmful | self.said


MEASURED_ELSEWHERE = Use(frozenset({"wiring"}), frozenset({"plant"}))
"""A model in use on a rig: it must be wired and scaled alike."""
GOING_ON = Use(frozenset({"wiring", "plant", "experiment"}), frozenset({"patience"}), ("daemon",))
"""Something unfinished that goes on: as it began."""


@dataclass(frozen=True)
class Difference:
    """One key that differs.

    Parameters
    ----------
    key : str
    before, now : any
        None where it is not there.
    is_harmful : bool
    what : str
        Of the key, where that is not its value.
    """

    key: str
    before: Any
    now: Any
    is_harmful: bool
    what: str = ""

    @property
    def text(self) -> str:
        """It in words."""
        return f"{self.key}{self.what} was {_shown(self.before)}, is {_shown(self.now)}"


def differences(
    before: Mapping[str, Any], config: BaseModel, use: Use, parts: Mapping[str, str] | None = None
) -> list[Difference]:
    """Compare settings that were in force with those of now.

    Parameters
    ----------
    before : mapping
        Tables within each other, as of an `Origin`; what it does not tell is not compared.
    config : Section
        A whole rig file.
    use : Use
    parts : mapping of str to str, optional
        Checksums of the files that they named, by key.
    """
    then, today = flat(before), flat(config.model_dump(mode="json"))
    options = {".".join(key) for key in file_options(config)}
    found = []
    for key in dict.fromkeys([*today, *then]):
        path = key.split(".")
        role = role_at(type(config), path)
        is_told = key in then or (is_free(type(config), path) and path[0] in before)
        if role is None or not is_told or not use.concerns(key, role):
            continue
        if _same(then.get(key), today.get(key), key in options or is_path(type(config), path)):
            continue
        found.append(Difference(key, then.get(key), today.get(key), role in use.harmful))
    keys = {each.key for each in found}
    return found + [each for each in _other_files(parts or {}, config, use) if each.key not in keys]


def measured_otherwise(what: str, provenance: Mapping[str, str], config: BaseModel, where: str) -> list[Difference]:
    """Return what differs between the rig that a model was measured on and a rig as it is wired now.

    Parameters
    ----------
    what : str
        Kind of the rig, such as "vibrator".
    provenance : mapping of str to str
        The model's words: its configuration or, without one, the rig's name, where they tell that.
    config : Section
        Of the rig now.
    where : str
        Names the model in an error.

    Raises
    ------
    OriginError : its configuration cannot be read.
    """
    origin = Origin.told(f"{what} model", provenance, where)
    if origin is not None:
        return differences(origin.settings, config, MEASURED_ELSEWHERE, origin.parts)
    return differences({"rig": {"name": provenance["rig"]}} if "rig" in provenance else {}, config, MEASURED_ELSEWHERE)


def _other_files(parts: Mapping[str, str], config: BaseModel, use: Use) -> Iterator[Difference]:
    """Yield the keys whose files hold something else."""
    today = sums_of(config) if parts else {}
    for key, total in parts.items():
        role = role_at(type(config), key.split("."))
        if role is not None and use.concerns(key, role) and today.get(key) != total:
            yield Difference(key, _short(total), _short(today.get(key)), role in use.harmful, CONTENT)


def _same(before: Any, now: Any, is_path: bool) -> bool:
    """Whether two values are the same; of paths, the names count: folders are moved."""
    if is_path and isinstance(before, str) and isinstance(now, str):
        return PurePath(before).name == PurePath(now).name
    if is_path and isinstance(before, list) and isinstance(now, list):
        return len(before) == len(now) and all(_same(a, b, True) for a, b in zip(before, now, strict=True))
    return bool(before == now)


def changed_parts(origin: Origin, parts: Mapping[str, str]) -> list[Difference]:
    """Compare the files that a thing was made of with those of now, by their checksums.

    Parameters
    ----------
    origin : Origin
    parts : mapping of str to str
        Checksums; a part that is not there has none.
    """
    names = dict.fromkeys([*origin.parts, *parts])
    pairs = ((name, origin.parts.get(name), parts.get(name)) for name in names)
    return [Difference(name, _short(then), _short(now), True) for name, then, now in pairs if then != now]


def agreed(found: Sequence[Difference], accept: Collection[str], what: str, way_out: str) -> list[str]:
    """Refuse harmful differences that nobody has accepted, and return what is to be said of the others.

    Parameters
    ----------
    found : sequence of Difference
    accept : collection of str
        Keys, as by `--accept`.
    what : str
        Begins each line, such as "model.h5 is of another wiring".
    way_out : str
        What else a person can do.

    Raises
    ------
    DisagreementError : a harmful one; the text names all, up to `MOST_SAID`.
    """
    refused = [each for each in found if each.is_harmful and each.key not in accept]
    if refused:
        more = f" (and {len(refused) - MOST_SAID} more)" if len(refused) > MOST_SAID else ""
        told = "; ".join(each.text for each in refused[:MOST_SAID])
        accepting = " ".join(f"--accept {each.key}" for each in refused)
        raise DisagreementError(f"{what}: {told}{more}; {way_out}, or go on all the same with {accepting}")
    return list(_notes(found, accept, what))


def accepted(found: Iterable[Difference], accept: Collection[str]) -> list[str]:
    """Return the keys whose harmful difference has been accepted."""
    return [each.key for each in found if each.is_harmful and each.key in accept]


def _notes(found: Sequence[Difference], accept: Collection[str], what: str) -> Iterator[str]:
    for each in found:
        yield f"{what}: {each.text}{'; accepted' if each.is_harmful else ''}"
    for key in accept:
        if key != CHANNELS and key not in [each.key for each in found]:
            yield f"--accept {key}{_IDLE}"


def _shown(value: Any) -> str:
    return "not there" if value is None else value_text(value)


def _short(checksum: str | None) -> str | None:
    return None if checksum is None else checksum[:12]
