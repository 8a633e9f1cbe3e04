"""What a difference in a key of a rig file means for what was made before."""

from collections.abc import Sequence
from typing import Literal

from pydantic import BaseModel

from rigkit.allowed import field_at, model_at

Role = Literal["wiring", "plant", "experiment", "patience"]
"""
wiring
    What a recorded number stands for, and what is connected to what: with another, old recordings and models are false.
plant
    Which simulated machine it is.
experiment
    What is done, and within which limits: with another, something unfinished would be of two kinds.
patience
    How long is waited and how it is run: results do not depend on it.
"""
ROLE = "role"
"""Where it stands, in a key's schema."""


def role_at(model: type[BaseModel], path: Sequence[str]) -> Role | None:
    """Return the role of a key of a rig file, or that of the table it stands in; None where there is no such key.

    Parameters
    ----------
    model : subclass of Section
        What a whole file holds.
    path : sequence of str
        Of tables, ending in the key; below a key that is a table of any keys, that key's role holds.
    """
    field, way = field_at(model, path)
    if field is None:
        return None
    declared = field.json_schema_extra
    own = declared.get(ROLE) if isinstance(declared, dict) else None
    table = model_at(model, way[:-1])
    return own or getattr(table, "role", "experiment")  # type: ignore[return-value]  # as `setting` takes it


def is_free(model: type[BaseModel], path: Sequence[str]) -> bool:
    """Whether a key stands in a table that may hold any keys, such as simulator.options.seed."""
    field, way = field_at(model, path)
    return field is not None and len(way) < len(path)
