"""What a simulated machine says of itself while it is there."""

import sys
from collections.abc import Mapping
from typing import Any

from rigkit.command import words, write_json


def say(text: str, json: str | None = None) -> None:
    """Write a line at once: whoever started the machine waits for it."""
    stream = words(json)
    stream.write(f"{text}\n")
    stream.flush()


def be_ready(text: str, figures: Mapping[str, Any], json: str | None) -> None:
    """Say how the machine is reached, and the same to a program that asked for it by `--json`."""
    write_json(json, figures)
    sys.stdout.flush()
    say(text, json)
