"""A pocket to be milled, and what milling it costs: the problem that every planner and the checker are given."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any

from rigkit.config_fault import LONGEST_VALUE

SIDES = {"E": "NS", "W": "NS", "N": "WE", "S": "WE"}
"""From which sides a feed cuts its strips."""
FEEDS = ("EW", "EWNS")
LARGEST_TOOL = 9
"""Cells: a type names its strip by one digit."""
LARGEST_POCKET = 1000
"""Cells along either side."""

_COSTS = ("t_acc", "step", "t_lift", "v_lift")


def shortened(value: Any) -> str:
    """Return a value as an error shows it."""
    text = repr(value)
    return text if len(text) <= LONGEST_VALUE else f"{text[:LONGEST_VALUE]}...{text[-1]}"


class PocketFault(ValueError):
    """A pocket that cannot be: the text names the key, its value and what is allowed."""


@dataclass(frozen=True)
class Pocket:
    """A pocket of rows x cols cells, the tool, and the cost of every move.

    Parameters
    ----------
    rows, cols : int
        Cells; one tool diameter is `G` of them.  Row 0 is north, column 0 west.
    G : int, cells, 1 to 9
    feeds : str
        "EW", or "EWNS" where the tool may feed along the rows as well.
    rate : mapping of type to float, s per cell along the feed
        For every type of `types`: feed, rows or columns milled, and hand (u, d; none for a slot), such as E2u and E3.
    closed : bool
        Whether walls stand around the pocket, which the tool's footprint must not cross.
    t_acc : float, s a segment
    step : float, s per cell of a move without a lift
    t_lift : float, s a lift
    v_lift : float, cells/s, or None where travelling lifted costs nothing
    theta : mapping of side to float, 1
        Factors on the rates of strips cut from a side.
    true : mapping
        What is really paid where it differs from the above: any of rate, theta, t_acc, step, t_lift, v_lift; a type by
        itself stands for its rate.
    """

    rows: int
    cols: int
    G: int
    feeds: str
    rate: Mapping[str, float]
    closed: bool = True
    t_acc: float = 0.0
    step: float = 0.0
    t_lift: float = 0.0
    v_lift: float | None = None
    theta: Mapping[str, float] = field(default_factory=dict)
    true: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Refuse what is no pocket."""
        _whole("G", self.G, 1, LARGEST_TOOL)
        for name in ("rows", "cols"):
            size = _whole(name, getattr(self, name), 1, LARGEST_POCKET)
            if size < self.G:
                raise PocketFault(f"{name} is {size}, smaller than the tool, must be >= G, {self.G} cells")
        if self.feeds not in FEEDS:
            raise PocketFault(f"feeds is {shortened(self.feeds)}, must be one of {', '.join(FEEDS)}")
        if not isinstance(self.closed, bool):
            raise PocketFault(f"closed is {shortened(self.closed)}, must be true or false")
        for name in ("t_acc", "step", "t_lift"):
            _number(name, getattr(self, name), " s, must be a number >= 0")
        if self.v_lift is not None:
            _positive("v_lift", self.v_lift, " cells/s, must be a number > 0 or null")
        self._check_rates()
        self._check_true()

    def _check_rates(self) -> None:
        for name, each, known, unit in (
            ("rate", self.rate, self.types, " s per cell"),
            ("theta", self.theta, self.sides, ""),
        ):
            if not isinstance(each, Mapping):
                raise PocketFault(f"{name} is {shortened(each)}, must be a table")
            for key, value in each.items():
                if key not in known:
                    raise PocketFault(f"{name} has {shortened(key)}, must be of {', '.join(known)}")
                _positive(f"{name}[{key}]", value, f"{unit}, must be a number > 0")
        missing = [name for name in self.types if name not in self.rate]
        if missing:
            raise PocketFault(f"rate has no {', '.join(missing)}, must have all of {', '.join(self.types)}")

    def _check_true(self) -> None:
        if not isinstance(self.true, Mapping):
            raise PocketFault(f"true is {shortened(self.true)}, must be a table")
        allowed = ("rate", "theta", *_COSTS, *self.types)
        for key in self.true:
            if key not in allowed:
                raise PocketFault(f"true has {shortened(key)}, must be of {', '.join(allowed)}")
        if self.true:
            try:
                self.paid()
            except PocketFault as fault:
                raise PocketFault(f"true: {fault}") from None

    @classmethod
    def from_dict(cls, given: Mapping[str, Any]) -> "Pocket":
        """Read a pocket from what its JSON file holds.

        Raises
        ------
        PocketFault : a key is missing, unknown, or out of its range.

        Examples
        --------
        >>> Pocket.from_dict({"rows": 4, "cols": 3, "G": 1, "feeds": "EW", "rate": {"E1": 0.1, "W1": 0.2}}).types
        ('E1', 'W1')
        """
        if not isinstance(given, Mapping):
            raise PocketFault(f"a pocket is {type(given).__name__}, must be a table")
        known = [each.name for each in fields(cls)]
        for key in given:
            if key not in known:
                raise PocketFault(f"the pocket has {shortened(key)}, must be of {', '.join(known)}")
        missing = [name for name in ("rows", "cols", "G", "feeds", "rate") if name not in given]
        if missing:
            raise PocketFault(f"the pocket has no {', '.join(missing)}")
        return cls(**given)

    @property
    def types(self) -> tuple[str, ...]:
        """Every milling type of this pocket: for each feed the slot, then the strips narrower than the tool."""
        return milling_types(self.G, self.feeds)

    @property
    def sides(self) -> tuple[str, ...]:
        """The sides from which strips are cut."""
        return tuple(dict.fromkeys(side for feed in self.feeds for side in SIDES[feed]))

    def paid(self) -> "Pocket":
        """Return the pocket with what is really paid in place of what is believed."""
        rates = {key: value for key, value in self.true.items() if key in self.types}
        given = dict(self.true.items())
        rate = {**self.rate, **_table("rate", given.pop("rate", {})), **rates}
        theta = {**self.theta, **_table("theta", given.pop("theta", {}))}
        costs = {key: value for key, value in given.items() if key in _COSTS}
        return replace(self, rate=rate, theta=theta, true={}, **costs)


def milling_types(tool: int, feeds: str) -> tuple[str, ...]:
    """Return the types that a tool of so many cells mills in."""
    narrow = [f"{k}{hand}" for k in range(tool - 1, 0, -1) for hand in "ud"]
    return tuple(f"{feed}{strip}" for feed in feeds for strip in (str(tool), *narrow))


def _table(name: str, given: Any) -> Mapping[str, Any]:
    if not isinstance(given, Mapping):
        raise PocketFault(f"{name} is {shortened(given)}, must be a table")
    return given


def _whole(name: str, value: Any, low: int, high: int) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or not low <= value <= high:
        raise PocketFault(f"{name} is {shortened(value)}, must be a whole number of cells, {low} to {high}")
    return value


def _number(name: str, value: Any, allowed: str) -> float:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if not is_number or not (value >= 0.0 and math.isfinite(value)):
        raise PocketFault(f"{name} is {shortened(value)}{allowed}")
    return float(value)


def _positive(name: str, value: Any, allowed: str) -> None:
    if not _number(name, value, allowed) > 0.0:
        raise PocketFault(f"{name} is {shortened(value)}{allowed}")
