"""Who may clear what has latched: a person who is named, after a fault, when the machine has come to rest."""

from typing import TypeVar

Cause = TypeVar("Cause")


def to_clear(what: str, cause: Cause | None, by: str, still: str = "") -> Cause:
    """Return what is to be cleared, in the name of the person who found out why it latched.

    Parameters
    ----------
    what : str
        That latches, such as "the guard".
    cause : any or None
        Why it has; None or "" where it has not.
    by : str
        Who clears it; not empty.
    still : str
        What must end before, such as "fades to zero"; empty where nothing does.

    Raises
    ------
    ValueError : nobody is named, nothing is latched, or `still` is not over.

    Examples
    --------
    >>> to_clear("the guard", "a sensor is at fault", "Ada")
    'a sensor is at fault'
    """
    if not by.strip():
        raise ValueError(f"{what} is cleared by {by!r}, must be a person's name")
    if not cause:
        raise ValueError(f"{what} is not latched, {by} has nothing to clear")
    if still:
        raise ValueError(f"{what} still {still}, {by} must clear it after that")
    return cause
