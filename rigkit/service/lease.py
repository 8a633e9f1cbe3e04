"""The one lease of control: who may command the rig now.  No clock of its own."""

import secrets
from dataclasses import dataclass
from hmac import compare_digest


class Refused(PermissionError):
    """A command from someone who may not give it; nothing has changed."""


@dataclass
class Holder:
    """Who has control.

    Parameters
    ----------
    who : str
    since, until : float, s, monotonic
    key : str
        What proves it.
    """

    who: str
    since: float
    until: float
    key: str


class Lease:
    """Control is one person's at a time, until given back, taken over, or not used for `seconds`.

    Parameters
    ----------
    seconds : float, s
    """

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self._holder: Holder | None = None

    def holder(self, now: float) -> Holder | None:
        """Return who has control at the time `now`, s."""
        if self._holder is not None and now >= self._holder.until:
            self._holder = None
        return self._holder

    def take(self, who: str, now: float, over: bool = False) -> tuple[Holder, str]:
        """Take control.

        Parameters
        ----------
        who : str
            Not empty.
        now : float, s, monotonic
        over : bool
            From whoever has it.

        Returns
        -------
        Holder
        str
            From whom it was taken; empty where nobody had it.

        Raises
        ------
        Refused : somebody has it, and `over` is False.
        ValueError : nobody is named.
        """
        if not who.strip():
            raise ValueError(f"control is asked for by {who!r}, must be a person's name")
        held = self.holder(now)
        if held is not None and not over:
            raise Refused(f"{held.who} has control; {who} may take it over")
        self._holder = Holder(who.strip(), now, now + self.seconds, secrets.token_urlsafe(16))
        return self._holder, held.who if held else ""

    def use(self, key: str, now: float) -> Holder:
        """Renew the lease that `key` proves.

        Raises
        ------
        Refused : it is not, or no more, that of who has control.
        """
        held = self.holder(now)
        if held is None or not compare_digest(held.key.encode(), key.encode()):
            whose = f"{held.who} has control" if held else "nobody has control"
            raise Refused(f"{whose}; take control first")
        held.until = now + self.seconds
        return held

    def give_back(self, key: str, now: float) -> Holder:
        """End the lease that `key` proves; return whose it was."""
        held = self.use(key, now)
        self._holder = None
        return held
