"""The events of the cell's runs in words, for their report."""

from collections.abc import Iterable, Mapping
from typing import Any

from rigkit.event_table import particulars
from stagectl.experiments.toroid.plan import SETUPS


def event_text(event: dict[str, Any]) -> str:
    """Return what an event of a run, a line of its `events.jsonl`, says, as a sentence or two."""
    match event["event"]:
        case "started":
            setup = setup_of(event)
            return f"Setup {setup}, {SETUPS.get(setup, 'unknown')}, with {event['software']}."
        case "held" if "part" in event:
            return f"Setup {setup_of(event)} is held, after {event['seconds']:g} s."
        case "resumed":
            done = f"{', '.join(event['done'])} had come to the end" if event["done"] else "none had come to its end"
            before = f"; what was recorded of the others before is in {event['before']}/" if "before" in event else ""
            return f"Resumed: {done}{before}."
        case "ended":
            return " ".join(_end(event))
        case _ if set(event) == {"time", "event", "reason"}:
            return f"Held: {event['reason']}."
    return particulars(event)


def _end(event: dict[str, Any]) -> list[str]:
    why = f"held: {event['reason']}" if event["reason"] else "without a fault"
    said = [f"Setup {setup_of(event)}, after {event['seconds']:g} s, {why}."]
    for name, counts in event.get("tracker", {}).items():
        received = counts["received"]
        wrong = ", ".join(f"{count} {what}" for what, count in counts.items() if count and what != "received")
        said.append(f"Of the {name} {received} samples came{': ' + wrong if wrong else ''}.")
    if "samples_at_end" in event:
        count = event["samples_at_end"]
        said.append(f"The stage was asked beyond its travel in {count} sample{'' if count == 1 else 's'} of 4 ms.")
    return said


def reasons_of(events: Iterable[Mapping[str, Any]]) -> dict[str, str]:
    """Return why setups were held, by setup: of those that have ended, empty for one that came to its end."""
    return {setup_of(event): event["reason"] for event in events if event["event"] == "ended"}


def setup_of(event: Mapping[str, Any]) -> str:
    """Return the setup that an event is of; version 0.1.0 called it so, and not a part."""
    found: str = event["part"] if "part" in event else event["setup"]
    return found
