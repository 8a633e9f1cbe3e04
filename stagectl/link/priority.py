"""What threads need that must answer within milliseconds: real-time priority where it is granted, and no pauses."""

import contextlib
import gc
import os
import sys
from collections.abc import Iterator

_TASKS = "/proc/self/task"
_TURN = 5e-4
"""s for which a thread of Python may keep others from running."""


@contextlib.contextmanager
def real_time() -> Iterator[None]:
    """Run the block, in this thread alone, before every ordinary process: the lowest real-time priority there is.

    For threads that mostly wait.  Where it is not granted (it needs root, or `ulimit -r`) the block runs as it would.
    """
    with _raised([0]):
        yield


@contextlib.contextmanager
def undisturbed() -> Iterator[None]:
    """Run the block without what makes threads of a program wait for each other for longer than milliseconds.

    No garbage is collected in it: that stops every thread, for 45 ms where it was measured.  Threads take turns ten
    times as often.  All that there are get real-time priority, and so do those that they start: one that has the
    interpreter's lock and not its turn on a busy machine would keep the others waiting.  Enter it before the other end
    is started.
    """
    turn, collects = sys.getswitchinterval(), gc.isenabled()
    gc.collect()
    gc.freeze()
    gc.disable()
    sys.setswitchinterval(_TURN)
    try:
        with _raised([int(task) for task in os.listdir(_TASKS)] if os.path.isdir(_TASKS) else []):
            yield
    finally:
        sys.setswitchinterval(turn)
        gc.unfreeze()
        if collects:
            gc.enable()


@contextlib.contextmanager
def _raised(threads: list[int]) -> Iterator[None]:
    """Give threads, 0 for this one, real-time priority for the length of the block."""
    if not hasattr(os, "sched_setscheduler"):
        yield
        return
    before = []
    for thread in threads:
        with contextlib.suppress(PermissionError, ProcessLookupError):
            policy, parameters = os.sched_getscheduler(thread), os.sched_getparam(thread)
            os.sched_setscheduler(thread, os.SCHED_FIFO, os.sched_param(os.sched_get_priority_min(os.SCHED_FIFO)))
            before.append((thread, policy, parameters))
    try:
        yield
    finally:
        for thread, policy, parameters in before:
            with contextlib.suppress(PermissionError, ProcessLookupError):
                os.sched_setscheduler(thread, policy, parameters)
