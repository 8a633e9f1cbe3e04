"""What threads need that must answer within milliseconds: real-time priority where it is granted, and no pauses."""

import contextlib
import gc
import os
import sys
from collections.abc import Iterator

_TASKS = "/proc/self/task"
_NOT_INHERITED = getattr(os, "SCHED_RESET_ON_FORK", 0)
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
def all_real_time() -> Iterator[None]:
    """Run the block with every thread that this program has now as `real_time` runs one.

    One of them that has the interpreter's lock and not its turn on a busy machine would keep the others waiting.  What
    they start meanwhile is ordinary.
    """
    with _raised(_threads(), _NOT_INHERITED):
        yield


@contextlib.contextmanager
def undisturbed() -> Iterator[None]:
    """Run the block without what makes threads of a program wait for each other for longer than milliseconds.

    No garbage is collected in it: that stops every thread, for 45 to 150 ms where it was measured.  Threads take turns
    ten times as often.  All that there are get real-time priority, and so do those that they start: one that has the
    interpreter's lock and not its turn on a busy machine would keep the others waiting.  Enter it before the other end
    is started.
    """
    turn = sys.getswitchinterval()
    with uncollected():
        sys.setswitchinterval(_TURN)
        try:
            with _raised(_threads()):
                yield
        finally:
            sys.setswitchinterval(turn)


@contextlib.contextmanager
def uncollected() -> Iterator[None]:
    """Run the block without a search for garbage, which stops every thread; afterwards all is as it was before.

    It is searched for once as the block is entered, for up to 0.15 s where it was measured, unless nothing is searched
    for already: enter it before the other end is open.
    """
    collects, is_frozen = gc.isenabled(), gc.get_freeze_count() > 0
    if not collects:
        yield
        return
    gc.collect()
    gc.freeze()
    gc.disable()
    try:
        yield
    finally:
        if not is_frozen:
            gc.unfreeze()
        gc.enable()


def _threads() -> list[int]:
    """Return the numbers of all threads of this program, where the system tells them."""
    return [int(task) for task in os.listdir(_TASKS)] if os.path.isdir(_TASKS) else []


@contextlib.contextmanager
def _raised(threads: list[int], more: int = 0) -> Iterator[None]:
    """Give threads, 0 for this one, real-time priority for the length of the block; those that have some keep theirs.

    A thread keeps the flags `more` of its policy afterwards, too: only root may take SCHED_RESET_ON_FORK away.
    """
    if not hasattr(os, "sched_setscheduler"):
        yield
        return
    lowest, before = os.sched_param(os.sched_get_priority_min(os.SCHED_FIFO)), []
    for thread in threads:
        with contextlib.suppress(PermissionError, ProcessLookupError):
            policy, parameters = os.sched_getscheduler(thread), os.sched_getparam(thread)
            if policy & ~_NOT_INHERITED in (os.SCHED_FIFO, os.SCHED_RR):
                continue
            os.sched_setscheduler(thread, os.SCHED_FIFO | more, lowest)
            before.append((thread, policy | more, parameters))
    try:
        yield
    finally:
        for thread, policy, parameters in before:
            with contextlib.suppress(PermissionError, ProcessLookupError):
                os.sched_setscheduler(thread, policy, parameters)
