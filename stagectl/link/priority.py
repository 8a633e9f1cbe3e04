"""What threads need that must answer within milliseconds: real-time priority where it is granted, and no pauses."""

import contextlib
import gc
import os
import sys
from collections.abc import Iterator

_TURN = 5e-4
"""s for which a thread of Python may keep others from running."""


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


@contextlib.contextmanager
def undisturbed() -> Iterator[None]:
    """Collect garbage now and not inside the block, and let threads take turns ten times as often as they would.

    A collection stops every thread of the process: 45 ms were seen, more than the `link.silence` of a rig.  Enter it
    before the other end is started.
    """
    turn, collects = sys.getswitchinterval(), gc.isenabled()
    gc.collect()
    gc.freeze()
    gc.disable()
    sys.setswitchinterval(_TURN)
    try:
        yield
    finally:
        sys.setswitchinterval(turn)
        gc.unfreeze()
        if collects:
            gc.enable()
