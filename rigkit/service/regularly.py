"""Work that is done again and again beside a procedure, such as drawing what it does."""

import threading
from collections.abc import Callable
from typing import Self


class Regularly:
    """Does something every so often, from a thread of its own, for the length of a `with` block, and once at its end.

    Parameters
    ----------
    work : callable()
    period : float, s
        From one end to the next beginning.
    """

    def __init__(self, work: Callable[[], object], period: float) -> None:
        self._work, self._period = work, period
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._repeat, name="regularly", daemon=True)

    def __enter__(self) -> Self:
        """Begin."""
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Do it a last time, and end."""
        self._over.set()
        self._thread.join()

    def _repeat(self) -> None:
        over = False
        while not over:
            over = self._over.wait(self._period)
            self._work()
