"""Waiting for another thread or process."""

import threading
import time
from collections.abc import Callable

_PAUSE = threading.Event()


def until(true: Callable[[], object], seconds: float = 30.0) -> None:
    """Return when `true` says so; fail after so long that it never will."""
    deadline = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < deadline, "it has not come to pass"
        _PAUSE.wait(0.002)
