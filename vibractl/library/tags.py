"""Tags of learned drives, `key=value`, and how far two sets of them are apart."""

import math
import re
from collections.abc import Iterable, Mapping, Sequence

FAR = 1.0
"""Distance of a tag that is missing, or is another text; as much as between the ends of a number's spread."""
_KEY = re.compile(r"[A-Za-z][\w.-]{0,39}")
_LONGEST = 80


def parsed(texts: Iterable[str]) -> dict[str, str]:
    """Read tags.

    Parameters
    ----------
    texts : iterable of str
        Each `key=value`.

    Raises
    ------
    ValueError : another form, a key given twice, or a number that is not finite.

    Examples
    --------
    >>> parsed(["depth=10", "place=tank"])
    {'depth': '10', 'place': 'tank'}
    """
    tags: dict[str, str] = {}
    for text in texts:
        key, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not _KEY.fullmatch(key) or not 0 < len(value) <= _LONGEST or not value.isprintable():
            raise ValueError(
                f"tag {text!r} is not key=value: a key is a letter and up to 39 letters, digits or . _ -, "
                f"a value 1 to {_LONGEST} characters"
            )
        if key in tags:
            raise ValueError(f"tag {key} is given twice, {tags[key]} and {value}")
        if (read := _as_float(value)) is not None and not math.isfinite(read):
            raise ValueError(f"tag {text!r}: {value} is not finite")
        tags[key] = value
    return tags


def distances(asked: Mapping[str, str], held: Sequence[Mapping[str, str]]) -> list[float]:
    """Say how far sets of tags are from those asked for: the sum over the tags asked for.

    A number counts by its difference over the spread of that tag over all sets and what is asked for; a text by
    whether it is the same; tags that are not asked for do not count.

    Parameters
    ----------
    asked : mapping of str
    held : sequence of mappings of str

    Returns
    -------
    list of floats, one a set
        0 is the same; `FAR` for each tag at most.

    Examples
    --------
    >>> distances({"depth": "12"}, [{"depth": "10"}, {"depth": "20"}, {}])
    [0.2, 0.8, 1.0]
    """
    total = [0.0] * len(held)
    for key, value in asked.items():
        wanted = _as_float(value)
        numbers = [_as_float(tags.get(key, "")) for tags in held]
        known = [number for number in (*numbers, wanted) if number is not None]
        spread = max(known) - min(known) if known else 0.0
        for place, (tags, number) in enumerate(zip(held, numbers, strict=True)):
            if wanted is not None and number is not None:
                total[place] += FAR * abs(number - wanted) / spread if number != wanted else 0.0
            elif tags.get(key) != value:
                total[place] += FAR
    return total


def _as_float(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None
