"""One value out of JSON by its path: keys, indices, and every item of a list or an object."""

import re
from collections.abc import Iterator
from typing import Any

_STEP = re.compile(r'\.?([A-Za-z_][\w-]*)|\.?"([^"]+)"|\[(-?\d+|\*)\]')
EVERY = "*"

Step = str | int


def steps(path: str) -> list[Step]:
    """Split a path such as `shots[-1].iae[*]` or `"learning.law".gain`.

    Raises
    ------
    ValueError : it is none.

    Examples
    --------
    >>> steps('axes[0].fit."a.b"[*]')
    ['axes', 0, 'fit', 'a.b', '*']
    """
    found: list[Step] = []
    place = 0
    while place < len(path):
        step = _STEP.match(path, place)
        if step is None or (place == 0 and path.startswith(".")):
            raise ValueError(f"path {path!r} is none, at {path[place:]!r}; must be such as shots[-1].iae[0]")
        name, quoted, index = step.groups()
        found.append(name or quoted or (EVERY if index == EVERY else int(index)))
        place = step.end()
    return found


def value_at(value: Any, path: str) -> Any:
    """Return what is at a path; a list of all where it goes through every item.

    Raises
    ------
    LookupError : there is nothing; the text says where the path ends.
    """
    walked = steps(path)
    values = list(_walk(value, walked, ""))
    return values if EVERY in walked else values[0]


def reduced(value: Any, how: str) -> Any:
    """Return one value of many, those that are null left out: min, max, mean, first, last or count.

    Examples
    --------
    >>> reduced([3, None, 5], "mean"), reduced([[1], [2, 3]], "count")
    (4.0, 3)
    """
    if not how:
        return value
    flat = [each for each in _flat(value) if each is not None]
    if how == "count":
        return len(flat)
    if not flat:
        return None
    match how:
        case "min":
            return min(flat)
        case "max":
            return max(flat)
        case "first":
            return flat[0]
        case "last":
            return flat[-1]
    return sum(flat) / len(flat)


def _walk(value: Any, path: list[Step], walked: str) -> Iterator[Any]:
    if not path:
        yield value
        return
    step, *rest = path
    if step == EVERY:
        if not isinstance(value, list | dict):
            raise LookupError(f"{walked or 'it'} is no list and no object")
        for name, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _walk(item, rest, f"{walked}[{name}]")
    elif isinstance(step, int):
        if not isinstance(value, list) or not -len(value) <= step < len(value):
            raise LookupError(f"{walked or 'it'} has no item {step}")
        yield from _walk(value[step], rest, f"{walked}[{step}]")
    else:
        if not isinstance(value, dict) or step not in value:
            there = f"; there are {', '.join(value)}" if isinstance(value, dict) else ""
            raise LookupError(f"{walked or 'it'} has no {step}{there}")
        yield from _walk(value[step], rest, f"{walked}.{step}".lstrip("."))


def _flat(value: Any) -> Iterator[Any]:
    if isinstance(value, list):
        for each in value:
            yield from _flat(each)
    else:
        yield value
