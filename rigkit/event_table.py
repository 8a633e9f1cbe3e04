"""What happened in a run, as a table of its report."""

from collections.abc import Callable, Iterable
from typing import Any

from rigkit.report import Table


def particulars(event: dict[str, Any]) -> str:
    """Return the fields of an event, a line of `events.jsonl`, beside its time and its name."""
    told = (
        f"{key} {value:.6g}" if isinstance(value, float) else f"{key} {value}"
        for key, value in event.items()
        if key not in ("time", "event")
    )
    return ", ".join(told)


def event_table(events: Iterable[dict[str, Any]], words: Callable[[dict[str, Any]], str] = particulars) -> Table:
    """Return a row for each event.

    Parameters
    ----------
    events : iterable of dict
        Lines of `events.jsonl`.
    words : callable(dict) -> str
        What the last column says of each.
    """
    rows = tuple((event["time"][:19].replace("T", " "), event["event"], words(event)) for event in events)
    return Table(("time, UTC", "event", "particulars"), rows)
