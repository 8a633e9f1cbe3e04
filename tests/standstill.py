"""How long the machine stood still while a test ran: the longest time that a thread beside it was not woken."""

import os
import threading
import time
from types import TracebackType
from typing import Self

INTERVAL = 0.005
"""s between two looks at the clock."""


class Standstill:
    """A thread on each core that only looks at the clock; `longest` is by how much one was late at the worst, s.

    It is late where the machine is busy elsewhere, is suspended by its host, one core or all, or where a thread of this
    process does not let go of the interpreter: whatever keeps time in the test beside it is late by about as much.
    """

    def __init__(self) -> None:
        self.longest = 0.0
        self._over = threading.Event()
        self._threads = [
            threading.Thread(target=self._look, args=(core,), name=f"standstill {core}", daemon=True)
            for core in sorted(os.sched_getaffinity(0))
        ]

    def __enter__(self) -> Self:
        """Begin to look."""
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, fault: BaseException | None, at: TracebackType | None) -> None:
        """End."""
        self._over.set()
        for thread in self._threads:
            thread.join()

    def _look(self, core: int) -> None:
        os.sched_setaffinity(threading.get_native_id(), {core})
        before = time.monotonic()
        while not self._over.wait(INTERVAL):
            now = time.monotonic()
            self.longest = max(self.longest, now - before - INTERVAL)
            before = now
