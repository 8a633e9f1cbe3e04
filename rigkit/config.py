"""Rig files: TOML read into strict models whose every key has a unit, a range and a default."""

from typing import Any

from pydantic import BaseModel, ConfigDict, Field


class Section(BaseModel):
    """A table of a rig file.  Unknown keys, inf, NaN and a bool for a number are refused."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False, validate_default=True)


def setting(default: Any, unit: str, text: str, **limits: Any) -> Any:
    """Declare one key of a `Section`: its default, its unit ("" for none), what it is for and its limits.

    `limits` are pydantic's own (`ge`, `gt`, `le`, `lt`, `min_length`, `max_length`, `pattern`).
    """
    return Field(default=default, description=text, json_schema_extra={"unit": unit}, **limits)
