"""What a thing was made of: settings, parts and software; kept with every model, calibration, run and entry."""

import hashlib
import tomllib
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Self

from pydantic import BaseModel

from rigkit import atomic
from rigkit.json_file import JsonError, json_value, read_json
from rigkit.json_text import json_text
from rigkit.provenance import now, software

PARTS = "parts"
"""Among the words of a model: checksums of the files that its rig file named, by key."""
RUN = "run.json"
"""In the folder of a run."""
SCHEMA = 1
_BLOCK = 2**20


class OriginError(ValueError):
    """A record of what a thing was made of that cannot be read."""


@dataclass(frozen=True)
class Origin:
    """What a thing was made of.

    Parameters
    ----------
    kind : str
        What it is, such as "vibrator run".
    settings : mapping
        The whole rig file as it was in force, tables within each other.
    parts : mapping of str to str
        SHA-256, hexadecimal, of each file that it was made of, by the name that it has there.
    software : str
    measured : str
        When its first sample was taken or, of a run, when it began: UTC, ISO 8601.
    accepted : tuple of str
        Keys whose difference a person has accepted.
    finished : str
        When all that was to come of it was there: UTC, ISO 8601; empty while it is not.
    designed : mapping
        What it is made again from beside settings and parts, as JSON has it: gains, what was asked for.
    """

    kind: str
    settings: Mapping[str, Any]
    parts: Mapping[str, str] = field(default_factory=dict)
    software: str = field(default_factory=software)
    measured: str = field(default_factory=now)
    accepted: tuple[str, ...] = ()
    finished: str = ""
    designed: Mapping[str, Any] = field(default_factory=dict)

    @classmethod
    def of(cls, kind: str, config: BaseModel, parts: Mapping[str, Path] | None = None) -> Self:
        """Return the origin of what is made now.

        Parameters
        ----------
        kind : str
        config : Section
            A whole rig file.
        parts : mapping of str to Path, optional
            Files that it is made of.

        Raises
        ------
        OSError : one cannot be read.
        """
        sums = {name: checksum(path) for name, path in (parts or {}).items()}
        return cls(kind, config.model_dump(mode="json"), sums)

    @classmethod
    def told(cls, kind: str, provenance: Mapping[str, str], where: str) -> Self | None:
        """Return the origin that a model's words tell; None where it holds no configuration.

        Parameters
        ----------
        kind : str
        provenance : mapping of str to str
        where : str
            Names the file in an error.

        Raises
        ------
        OriginError : its configuration, or what its files held, cannot be read.
        """
        text = provenance.get("config", "")
        if not text.strip():
            return None
        try:
            settings = tomllib.loads(text)
        except (ValueError, RecursionError) as fault:
            raise OriginError(f"{where}: the configuration it was made with is not TOML: {fault}") from None
        try:
            parts = json_value(provenance.get(PARTS, "{}"), f"{where}: {PARTS}", dict)
        except JsonError as fault:
            raise OriginError(str(fault)) from None
        measured = provenance.get("measured") or provenance.get("date") or provenance.get("made", "")
        return cls(kind, settings, parts, provenance.get("software", ""), measured)

    @property
    def flat(self) -> dict[str, Any]:
        """All settings by their whole key, such as audio.rate."""
        return flat(self.settings)

    def accepting(self, keys: Iterable[str]) -> Self:
        """Return it with keys whose difference has been accepted."""
        return replace(self, accepted=tuple(sorted({*self.accepted, *keys})))

    def write(self, path: Path) -> None:
        """Write it as JSON, whole or not at all."""
        atomic.write(path, self.text)

    @property
    def text(self) -> str:
        """It as JSON."""
        told = {"schema": SCHEMA, "kind": self.kind, "software": self.software, "measured": self.measured}
        told |= {"finished": self.finished}
        told |= {"accepted": list(self.accepted), "parts": dict(self.parts), "settings": dict(self.settings)}
        if self.designed:
            told |= {"designed": dict(self.designed)}
        return f"{json_text(told, indent=1)}\n"


def read_origin(path: Path) -> Origin | None:
    """Read the record at `path`; None where there is none.

    Raises
    ------
    OriginError : it cannot be read, or is of another schema.
    """
    if not path.is_file():
        return None
    try:
        told = read_json(path, dict)
    except JsonError as fault:
        raise OriginError(str(fault)) from None
    if told.get("schema") != SCHEMA:
        raise OriginError(f"{path}: schema is {told.get('schema')!r}, must be {SCHEMA}")
    wanted = {
        "kind": str,
        "software": str,
        "measured": str,
        "finished": str,
        "accepted": list,
        "parts": dict,
        "settings": dict,
        "designed": dict,
    }
    told.setdefault("designed", {})
    for name, kind in wanted.items():
        if not isinstance(told.get(name), kind):
            raise OriginError(f"{path}: {name} is {told.get(name)!r}, must be {kind.__name__}")
    texts = [*told["accepted"], *told["parts"].values()]
    if not all(isinstance(text, str) for text in texts):
        raise OriginError(f"{path}: accepted and parts must hold texts")
    values = {name: told[name] for name in wanted}
    return Origin(**{**values, "accepted": tuple(told["accepted"])})


def has_more(folder: Path, besides: Collection[str]) -> bool:
    """Whether a folder has files beside those that it was made of, by its record; hidden files do not count."""
    origin = read_origin(folder / RUN)
    made_of = {RUN, *besides, *(origin.parts if origin else ())}
    files = (path for path in folder.rglob("*") if path.is_file() and not path.name.startswith("."))
    return any(path.relative_to(folder).as_posix() not in made_of for path in files)


def checksum(path: Path) -> str:
    """Return the SHA-256 of a file, hexadecimal."""
    found = hashlib.sha256()
    with path.open("rb") as file:
        while block := file.read(_BLOCK):
            found.update(block)
    return found.hexdigest()


def flat(settings: Mapping[str, Any], above: str = "") -> dict[str, Any]:
    """Return nested tables as one, by whole keys.

    Examples
    --------
    >>> flat({"audio": {"rate": 44100}, "rig": {"name": "A"}})
    {'audio.rate': 44100, 'rig.name': 'A'}
    """
    found: dict[str, Any] = {}
    for name, value in settings.items():
        key = f"{above}{name}"
        if isinstance(value, Mapping):
            found |= flat(value, f"{key}.")
        else:
            found[key] = value
    return found
