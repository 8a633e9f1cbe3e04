"""Work that a clock must not wait for, files and figures: in a process of its own, or here where none waits."""

import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from typing import Any

_NICENESS = 10


class Here(Executor):
    """Does what it is asked for at once, in the caller's thread."""

    def submit(self, call: Callable[..., Any], /, *arguments: Any, **keywords: Any) -> Future[Any]:
        """Do it, and return what came of it."""
        done: Future[Any] = Future()
        done.set_result(call(*arguments, **keywords))
        return done


@contextmanager
def aside(prepare: Callable[[], None]) -> Iterator[Executor]:
    """Give a process of its own, less urgent than this one; the block's end waits for its work.

    Parameters
    ----------
    prepare : callable()
        Called there before this returns: to import what takes long.
    """
    with ProcessPoolExecutor(1, get_context("spawn"), _begin) as process:
        process.submit(prepare).result()
        yield process


def _begin() -> None:
    """Leave Ctrl-C to the process that gives the work."""
    os.nice(_NICENESS)
    for each in (signal.SIGINT, signal.SIGTERM, signal.SIGUSR1, signal.SIGUSR2):
        signal.signal(each, signal.SIG_IGN)
