"""A rig file with some values changed: comments, order and everything else stay as a person has written them."""

from collections.abc import Mapping
from typing import Any

import tomlkit
from pydantic import BaseModel

from rigkit.origin import flat


def edited(text: str, changes: Mapping[str, Any]) -> str:
    """Return the text of a rig file with other values.

    Parameters
    ----------
    text : str
        TOML.
    changes : mapping of str to value
        By the whole key, such as inner.gain; tables that lack are added at the end.
    """
    document = tomlkit.parse(text)
    for key, value in changes.items():
        *tables, name = key.split(".")
        place: Any = document
        for table in tables:
            if table not in place:
                place[table] = tomlkit.table()
            place = place[table]
        place[name] = list(value) if isinstance(value, tuple) else value
    return tomlkit.dumps(document)


def with_tables(text: str, config: BaseModel, tables: tuple[str, ...]) -> str:
    """Return the text of a rig file with all values that some tables of a configuration have.

    Parameters
    ----------
    text : str
        TOML.
    config : Section
        A whole rig file.
    tables : tuple of str
    """
    values = flat(config.model_dump(mode="json"))
    return edited(text, {key: value for key, value in values.items() if key.split(".")[0] in tables})
