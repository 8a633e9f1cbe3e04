"""The files that a rig file names, and what they hold: it belongs to what a thing is made of."""

import hashlib
from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from rigkit.config_options import file_options
from rigkit.config_paths import Key, path_keys, paths_of, suffixes, value_at
from rigkit.config_role import Role, role_at
from rigkit.origin import checksum


def sums_of(config: BaseModel) -> dict[str, str]:
    """Return what the files hold that say how a rig is wired and which plant it is: a checksum by each key.

    Parameters
    ----------
    config : Section
        A whole rig file; files that are not there are left out.
    """
    found = {}
    for key, value, endings in paths_in(config, frozenset({"wiring", "plant"})):
        sums = [checksum(path) for path in paths_of(value, endings) if path.is_file()]
        if sums:
            found[".".join(key)] = sums[0] if len(sums) == 1 else hashlib.sha256("".join(sums).encode()).hexdigest()
    return found


def paths_in(config: BaseModel, roles: frozenset[Role]) -> Iterator[tuple[Key, Any, tuple[str, ...]]]:
    """Yield the keys of some roles that may hold paths, with their values and the suffixes by which those are paths.

    Parameters
    ----------
    config : Section
        A whole rig file.
    roles : set of Role
    """
    values = config.model_dump()
    found = [(key, value_at(values, key), suffixes(field)) for key, field in path_keys(type(config))]
    found += [(key, value, ("",)) for key, value in file_options(config).items()]
    return (each for each in found if role_at(type(config), each[0]) in roles)
