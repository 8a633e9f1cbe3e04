"""Who is told of faults and acknowledgements: a run's log, or nobody."""

from collections.abc import Callable, Mapping
from typing import Any

Tell = Callable[[str, Mapping[str, Any]], object]
"""Takes an event and its fields."""


def nobody(*_: object) -> None:
    """Tell nobody."""
