"""The headline rows of docs/identification-peers.md: where ours wins and where it loses."""

import re
from collections.abc import Iterator

from benchmarks.page_table import DOCS

PAGE = DOCS / "identification-peers.md"
OURS = "ours"
HEAD = (
    "records",
    "ours: processor, ms",
    "fastest peer",
    "ours: one step short, points",
    "best peer",
    "ours: free run short",
    "best peer",
)
_CASE = re.compile(r"^### (Order .*)$", re.MULTILINE)
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")


def made() -> str:
    """Return when that page was made, and on what."""
    return PAGE.read_text(encoding="utf-8").split("\n\n")[1].split(", ", 1)[1].replace("\n", " ")


def rows() -> list[list[str]]:
    """Return a row for each case: ours as it comes, and the best of the peers in each respect."""
    parts = _CASE.split(PAGE.read_text(encoding="utf-8"))
    return [_row(title, body) for title, body in zip(parts[1::2], parts[2::2], strict=True) if "| ours |" in body]


def _row(title: str, body: str) -> list[str]:
    found = {name: numbers for name, numbers in _numbers(body) if numbers[0] is not None}
    peers = {name: numbers for name, numbers in found.items() if not name.startswith(OURS)}
    cells = [title]
    for column in (0, 2, 1):
        name = min(peers, key=lambda each, n=column: _or_last(peers[each][n]))  # type: ignore[misc]
        cells += [f"{found[OURS][column]:g}", f"{name}: {peers[name][column]:g}"]
    return cells


def _numbers(body: str) -> Iterator[tuple[str, tuple[float | None, ...]]]:
    """Yield each method, and its processor time, ms, free run short and one step short, points."""
    for line in body.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if line.startswith("| ") and len(cells) == 8 and _NUMBER.match(cells[2]):
            yield cells[0], tuple(_first(cells[n]) for n in (2, 5, 6))


def _first(cell: str) -> float | None:
    found = _NUMBER.match(cell)
    return float(found.group()) if found else None


def _or_last(value: float | None) -> float:
    return float("inf") if value is None else value
