"""What the commands that identify models take as text: channels, and an order."""


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
