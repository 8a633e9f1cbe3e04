"""How long the machine stood still while a test ran: the longest time that a thread beside it was not woken."""

import threading
import time
from types import TracebackType
from typing import Self

INTERVAL = 0.002
"""s between two looks at the clock."""


class Standstill:
    """A thread that only looks at the clock; `longest` is by how much it was late at the worst, s.

    It is late where the machine is busy elsewhere, is suspended by its host, or where a thread of this process does
    not let go of the interpreter: whatever keeps time in the test beside it is late by about as much.
    """

    def __init__(self) -> None:
        self.longest = 0.0
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._look, name="standstill", daemon=True)

    def __enter__(self) -> Self:
        """Begin to look."""
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, fault: BaseException | None, at: TracebackType | None) -> None:
        """End."""
        self._over.set()
        self._thread.join()

    def _look(self) -> None:
        before = time.monotonic()
        while not self._over.wait(INTERVAL):
            now = time.monotonic()
            self.longest = max(self.longest, now - before - INTERVAL)
            before = now
