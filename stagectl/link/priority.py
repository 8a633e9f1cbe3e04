"""Real-time priority for the threads that must answer within milliseconds, where the system grants it."""

import contextlib
import os
from collections.abc import Iterator


@contextlib.contextmanager
def real_time() -> Iterator[None]:
    """Run the block, in this thread alone, before every ordinary process: the lowest real-time priority there is.

    For threads that mostly wait.  Where it is not granted (it needs root, or `ulimit -r`) the block runs as it would.
    """
    if not hasattr(os, "sched_setscheduler"):
        yield
        return
    before, parameters = os.sched_getscheduler(0), os.sched_getparam(0)
    with contextlib.suppress(PermissionError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(os.sched_get_priority_min(os.SCHED_FIFO)))
    try:
        yield
    finally:
        with contextlib.suppress(PermissionError):
            os.sched_setscheduler(0, before, parameters)
