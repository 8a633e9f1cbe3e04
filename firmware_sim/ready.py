"""What a simulated machine says of itself while it is there."""

import sys


def say(text: str) -> None:
    """Write a line at once: whoever started the machine waits for it."""
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()
