"""What stands above the columns of a table: a name, and a unit in brackets."""

import re
from collections.abc import Sequence

_TITLE = re.compile(r"(?P<name>.*?)\s*(?:\[(?P<unit>[^\[\]]*)\]|\((?P<other>[^()]*)\))?", re.DOTALL)


def names_and_units(titles: Sequence[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return names and units of titles as "force [N]" or "force (N)"; units are 1 where none is said.

    Parameters
    ----------
    titles : sequence of str

    Examples
    --------
    >>> names_and_units(["force [N]", "x (um)", "step"])
    (('force', 'x', 'step'), ('N', 'um', '1'))
    """
    names, units = [], []
    for title in titles:
        found = _TITLE.fullmatch(title.strip())
        name, unit = (found["name"], found["unit"] or found["other"]) if found else (title, None)
        names.append(name.strip() or title.strip())
        units.append((unit or "").strip() or "1")
    return tuple(names), tuple(units)
