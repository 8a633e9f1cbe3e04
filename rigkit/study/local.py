"""The cores of one machine as the workers of a study."""

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from rigkit.study.crew import Crew
from rigkit.study.outcome import Outcome
from rigkit.study.task import Task


@dataclass(frozen=True)
class Local:
    """Threads that each wait for a worker process."""

    executor: ThreadPoolExecutor
    perform: Callable[[Task], Outcome]
    slots: int
    lost: tuple[type[BaseException], ...] = ()


@contextmanager
def local(count: int, files: Path, scratch: Path) -> Iterator[Local]:
    """Give `count` workers on this machine; they end with the block, whatever they do.

    Parameters
    ----------
    count : int
    files, scratch : Path
        As of `perform`.
    """
    crew = Crew(count, files, scratch)
    with ThreadPoolExecutor(count) as executor:
        try:
            yield Local(executor, crew.perform, count)
        finally:
            crew.end()
            executor.shutdown(cancel_futures=True)
