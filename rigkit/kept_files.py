"""A run's own copies of the files that its rig file names, so that it is whole wherever it is moved."""

import json
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from pydantic import BaseModel

from rigkit.config_files import paths_in
from rigkit.config_paths import each_path, value_at
from rigkit.run_folder import RunFolder

Config = TypeVar("Config", bound=BaseModel)


@dataclass(frozen=True)
class KeptFiles(Generic[Config]):
    """A run's own copies of files that its rig file names.

    Parameters
    ----------
    config : Section
        That names the copies, relative to the folder of the run.
    files : mapping of str to Path
        What is to be copied, by its name in that folder.
    """

    config: Config
    files: Mapping[str, Path]

    def take_into(self, folder: RunFolder) -> list[str]:
        """Copy them into the folder of the run; return their names there."""
        for name, source in self.files.items():
            folder.take_in(source, name)
        return list(self.files)


def kept_files(config: Config, but: Collection[str] = (), within: str = "files") -> KeptFiles[Config]:
    """Return what a run has to copy so that it is whole wherever it is moved.

    Parameters
    ----------
    config : Section
        A whole rig file.
    but : collection of str
        Keys that the run does not depend on, or whose files it keeps by itself.
    within : str
        Folder of the copies in that of the run.  Each has one of its own there, and the name that it had.
    """
    values, names = config.model_dump(mode="json"), dict[Path, str]()

    def kept(text: str) -> str:
        path = Path(text)
        return names.setdefault(path, f"{within}/{len(names) + 1}/{path.name}") if path.is_file() else text

    for key, value, endings in paths_in(config, frozenset({"wiring", "plant", "experiment"})):
        if ".".join(key) not in but:
            value_at(values, key[:-1])[key[-1]] = each_path(value, endings, kept)
    made = type(config).model_validate_json(json.dumps(values)) if names else config
    return KeptFiles(made, {name: path for path, name in names.items()})
