"""Whether what is told of a fault tells every sentence once: in the state's reason and in each event of the log."""

import re
from collections.abc import Mapping
from typing import Any

from rigkit.service.control import Control

SHORTEST = 12
"""Characters of what counts as a sentence: names and units may come twice."""


def repeated(text: str) -> list[str]:
    """Return the sentences, between colons, semicolons and full stops, that come twice, whatever their numbers are."""
    parts = [re.sub(r"\d+", "0", part.strip()) for part in re.split(r"[;:\n](?=\s)|\.(?=\s|$)", text)]
    return sorted({part for part in parts if len(part) >= SHORTEST and parts.count(part) > 1})


def check_told_once(control: Control) -> None:
    """Look at the state's reason, and at every event that is kept."""
    assert repeated(control.machine.last.why) == [], control.machine.last.why
    for event in control.journal.since(0):
        for text in _texts(event):
            assert repeated(text) == [], f"{event['event']}: {text}"


def _texts(event: Mapping[str, Any]) -> list[str]:
    """Return the texts of an event; its settings are none."""
    return [value for key, value in event.items() if isinstance(value, str) and key != "settings"]
