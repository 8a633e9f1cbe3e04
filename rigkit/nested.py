"""Tables and lists within each other, as TOML and JSON have them, looked through without recursion."""

from collections.abc import Iterator
from typing import Any

Path = tuple[str, ...]
"""Keys, and numbers in lists from 0, from the outermost table to a value."""


def nodes(values: Any, path: Path = ()) -> Iterator[tuple[Path, Any]]:
    """Yield everything in `values` with its path, a table or list before what is in it, in the order of the file.

    Examples
    --------
    >>> [path for path, _ in nodes({"a": [1, 2], "b": 3})]
    [(), ('a',), ('a', '0'), ('a', '1'), ('b',)]
    """
    waiting: list[tuple[Path, Any]] = [(path, values)]
    while waiting:
        path, value = waiting.pop()
        yield path, value
        match value:
            case dict():
                waiting += [((*path, key), item) for key, item in reversed(value.items())]
            case list():
                waiting += [((*path, str(number)), item) for number, item in reversed(list(enumerate(value)))]
