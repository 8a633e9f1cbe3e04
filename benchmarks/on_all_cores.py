"""The same measurement of many seeds, on as many processes as there are cores; results come in the seeds' order."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from os import sched_getaffinity
from typing import Any, TypeVar

from threadpoolctl import threadpool_limits

Result = TypeVar("Result")


def over_seeds(measure: Callable[..., Result], seeds: Sequence[int], **fixed: Any) -> Iterator[Result]:
    """Return `measure(seed, **fixed)` of every seed."""
    cores = len(sched_getaffinity(0))
    with ProcessPoolExecutor(cores, get_context("fork"), threadpool_limits, (1,)) as pool:
        yield from pool.map(partial(measure, **fixed), seeds)
