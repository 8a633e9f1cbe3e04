"""Linear algebra of small matrices on one thread: handing them to several costs more than it saves.

On two cores that others use as well, a fit of order 18 takes 15 times as long with OpenBLAS' default of one thread a
core: each of its thousands of products waits for the slower of two threads.
"""

from collections.abc import Callable
from functools import cache, wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import ThreadpoolController

P = ParamSpec("P")
R = TypeVar("R")


def on_one_thread(function: Callable[P, R]) -> Callable[P, R]:
    """Let a function do its linear algebra on the calling thread; as it was before when it returns."""

    @wraps(function)
    def limited(*arguments: P.args, **named: P.kwargs) -> R:
        with _controller().limit(limits=1):
            return function(*arguments, **named)

    return limited


@cache
def _controller() -> ThreadpoolController:
    """Find the libraries once, when they are loaded."""
    return ThreadpoolController()
