"""A record as compiled kernels see it, for type checkers: an element of an array of a structured dtype."""

from typing import Any


class Record:
    """Fields by name, of whatever types; nothing is ever made of it: numpy's own has methods among its names."""

    def __getattr__(self, name: str) -> Any:
        """Return a field."""
        raise NotImplementedError

    def __setattr__(self, name: str, value: Any) -> None:
        """Set a field."""
        raise NotImplementedError
