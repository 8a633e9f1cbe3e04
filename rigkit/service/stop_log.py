"""STOPs in the event log: the first of each asker at once, and of those that follow how many there were."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rigkit.service.journal import Journal, now

SHORTEST, LONGEST = 1.0, 60.0
"""s between two entries of one asker; each pause is twice the one before."""
ASKERS = 20
"""That are told apart; all others count as one."""
OTHERS = "others"


@dataclass
class _Series:
    """STOPs of one asker since the state has changed last."""

    since: str
    due: float
    newest: float
    pause: float = SHORTEST
    times: int = 1
    entry: int = 0
    """Number of its newest entry that counts; 0 where there is none."""
    waiting: tuple[str, dict[str, Any]] | None = None
    """Who, and what of it: not in the log yet."""


class StopLog:
    """Adds STOPs to the event log.  Nobody's STOPs can fill it: in memory each asker has two entries.

    Parameters
    ----------
    journal : Journal
    """

    def __init__(self, journal: Journal) -> None:
        self._journal = journal
        self._series: dict[str, _Series] = {}

    def add(self, asker: str, who: str, fields: Mapping[str, Any], at: float) -> None:
        """Add a STOP, or count it.

        Parameters
        ----------
        asker : str
            By what repeats are known, such as the role and address of a request; `who` is only a name.
        who : str
        fields : mapping
        at : float, s, of a monotonic clock
        """
        if asker not in self._series and len(self._series) >= ASKERS:
            asker = OTHERS
        series = self._series.get(asker)
        if series is None:
            self._series[asker] = _Series(now(), at + SHORTEST, at)
            self._journal.add("stop", who, fields)
            return
        if at - series.newest > LONGEST:
            series.pause = SHORTEST
        series.times, series.newest = series.times + 1, at
        series.waiting = who, {**fields, "times": series.times, "since": series.since, "asker": asker}
        self.settle(at)

    def settle(self, at: float) -> None:
        """Tell what has waited long enough."""
        for series in self._series.values():
            if series.waiting is not None and at >= series.due:
                self._tell(series)
                series.due, series.pause = at + series.pause, min(2 * series.pause, LONGEST)

    def end(self) -> None:
        """Tell what waits, and begin anew: the state changes."""
        for series in self._series.values():
            if series.waiting is not None:
                self._tell(series)
        self._series.clear()

    def _tell(self, series: _Series) -> None:
        assert series.waiting is not None
        who, fields = series.waiting
        series.waiting = None
        series.entry = self._journal.add("stop", who, fields, series.entry)
