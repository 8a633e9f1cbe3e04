"""Tables of figures as Markdown, printed, and with `--write` put into their page of `docs/`.

A page holds a table between `<!-- NAME -->` and `<!-- end of NAME -->`; what stands between is replaced.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

DOCS = Path(__file__).parents[1] / "docs"
FLAG = "--write"


def table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Return a Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(map(str, cells))} |" for cells in lines)


def put(text: str, page: str, name: str) -> None:
    """Print a table, and write it to the page when the command line says so."""
    print(f"\n{text}\n")
    if FLAG in sys.argv:
        file = DOCS / page
        file.write_text(replaced(file.read_text(encoding="utf-8"), name, text), encoding="utf-8")


def replaced(page: str, name: str, text: str) -> str:
    """Return a page with what stands between the marks of `name` replaced."""
    begin, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->"
    if page.count(begin) != 1 or page.count(end) != 1:
        raise ValueError(f"the page must have {begin.strip()} and {end} once each")
    before, rest = page.split(begin)
    return f"{before}{begin}{text}\n{end}{rest.split(end)[1]}"


def told(value: float, form: str = "g", never: str = "never") -> str:
    """Return a figure as text; an infinite one is a shot that never came."""
    return never if np.isinf(value) else format(value, form)


def spread(values: Sequence[float], form: str = "g") -> str:
    """Return the median, and the largest in brackets."""
    return f"{told(float(np.median(values)), form)} ({told(max(values), form)})" if values else "-"


def words() -> list[str]:
    """Return what else the command line says."""
    return [text for text in sys.argv[1:] if text != FLAG]
