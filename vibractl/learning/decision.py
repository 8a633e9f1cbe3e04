"""What the learning decides out of the ordinary."""

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Decision:
    """Something out of the ordinary that was decided, and the values that decided it."""

    event: str
    fields: dict[str, Any]


def tidy(value: float) -> float:
    """Round a figure for the events: to four digits after the point."""
    return round(float(value), 4)
