"""The person beside the robot, who is asked before it moves."""

import os
import select
import sys
from collections.abc import Callable

from rigkit.posix import refuse_without, termios
from rigkit.stop import Stopped

_LOOK = 0.1
"""s between two looks at whether it is to stop."""


class Person:
    """Confirms at the terminal, by Enter; or is not asked.

    Parameters
    ----------
    tell : callable(str)
    asks : bool

    Raises
    ------
    ValueError : it is to ask, and the standard input is no terminal.
    """

    def __init__(self, tell: Callable[[str], None], asks: bool) -> None:
        if asks:
            refuse_without_terminal()
        self.tell, self._asks = tell, asks

    def confirm(self, what: str, stopped: Callable[[], bool]) -> None:
        """Say what comes, and wait for Enter; what was typed before does not count.

        Parameters
        ----------
        what : str
        stopped : callable() -> bool
            Asked while it waits.

        Raises
        ------
        Stopped : it is to stop.
        ValueError : the terminal has gone.
        OSError : the system has none.
        """
        self.tell(f"{what}; then Enter" if self._asks else what)
        if not self._asks:
            return
        refuse_without(termios, "terminals, at which a person confirms")
        line = sys.stdin.fileno()
        termios.tcflush(line, termios.TCIFLUSH)
        while not stopped():
            if select.select([line], [], [], _LOOK)[0]:
                if not os.read(line, 1_024):
                    raise ValueError("the terminal has gone: no confirmation")
                return
        raise Stopped("stopped before the robot moved on: it is held")


def refuse_without_terminal() -> None:
    """Refuse to ask where nobody can answer, by ValueError."""
    if not sys.stdin.isatty():
        raise ValueError(
            "the standard input is no terminal: nobody can confirm that the block is in its place; --yes goes on "
            "without confirmation"
        )
