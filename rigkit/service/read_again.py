"""A daemon's rig file, read at its start and at each reload."""

from collections.abc import Sequence
from pathlib import Path
from typing import Generic, TypeVar

from rigkit import config as rig_file
from rigkit.config import Section
from rigkit.named_code import KnownCode

Config = TypeVar("Config", bound=Section)


class ReadAgain(Generic[Config]):
    """Read a rig file when called; code that it did not name the first time is never imported for it.

    Parameters
    ----------
    path : Path or None
    model : subclass of Section
        What a whole file holds.
    overrides : sequence of str, "table.key=value"
        Laid over it each time.
    """

    def __init__(self, path: Path | None, model: type[Config], overrides: Sequence[str]) -> None:
        self._path, self._model, self._overrides = path, model, overrides
        self._known: KnownCode | None = None

    def __call__(self) -> Config:
        """Read it.

        Raises
        ------
        ConfigError : it cannot be used.
        """
        made = rig_file.load(self._path, self._model, self._overrides, trusts=self._trusts)
        self._known = self._known or KnownCode(made)
        return made

    def _trusts(self, config: Config) -> bool:
        return self._known is None or self._known.has_all_of(config)
