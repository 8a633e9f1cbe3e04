"""What the commands that identify models take as text: channels, an order, dead times."""

from typing import Literal


def channels_of(option: str, text: str | None) -> list[str]:
    """Return channels, by name or number, that have commas between them.

    Raises
    ------
    ValueError : there are none, or one is empty.
    """
    if text is None:
        raise ValueError(f"{option} is not given, must name channels of DATA")
    names = [name.strip() for name in text.split(",")]
    if not all(names):
        raise ValueError(f"{option} is {text!r}, must be names or numbers with commas between")
    return names


def delay_of(text: str) -> Literal["auto"] | int | tuple[int, ...]:
    """Return the dead times that `--delay` gives, samples.

    Raises
    ------
    ValueError : one is no number.
    """
    if text == "auto":
        return "auto"
    parts = [part.strip() for part in text.split(",")]
    if not all(part.isdecimal() for part in parts):
        raise ValueError(f"--delay is {text!r}, must be auto, samples >= 0 of all inputs, or of each, with commas")
    late = tuple(int(part) for part in parts)
    return late[0] if len(late) == 1 else late


def order_of(text: str) -> int | None:
    """Return the order that `--order` asks for; None: as proposed.

    Raises
    ------
    ValueError : it is no number.
    """
    if text == "auto":
        return None
    if not (text.isdecimal() and int(text) >= 1):
        raise ValueError(f"--order is {text!r}, must be auto or a whole number >= 1")
    return int(text)
