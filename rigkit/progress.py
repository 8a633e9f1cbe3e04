"""Progress of a long command on stderr: a bar with the time left, or a plain line now and then."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Protocol, TextIO

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

SECONDS_BETWEEN_LINES = 10.0
"""At least, where the output is no terminal."""

_TELL: ContextVar[Callable[[float, float, str], None] | None] = ContextVar("tell", default=None)


class Meter(Protocol):
    """What a long job reports to."""

    def show(self, done: float, note: str = "") -> None:
        """Say how much is done by now, of the total, and a word on how it goes."""

    def say(self, text: str) -> None:
        """Print a line that stays: something happened that a person should know."""


@contextmanager
def progress(title: str, total: float, *, start: float = 0.0, stream: TextIO | None = None) -> Iterator[Meter]:
    """Show the progress of the block.

    Parameters
    ----------
    title : str
        What is being done.
    total, start : float
        How much there is to do in all, and how much of it an earlier run did; any unit.
    stream : text stream
        Where to; stderr unless given.
    """
    tell = _TELL.get()
    if tell is not None:
        yield _ToldMeter(tell, title, total, start)
        return
    stream = stream or sys.stderr
    if not stream.isatty():
        yield PlainMeter(title, total, stream, time.monotonic)
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TimeRemainingColumn(),
        TextColumn("left"),
        TextColumn("{task.fields[note]}"),
    )
    with Progress(*columns, console=Console(file=stream)) as bar:
        yield _BarMeter(bar, title, total, start)


@contextmanager
def told_to(tell: Callable[[float, float, str], None]) -> Iterator[None]:
    """Let `tell(done, total, note)` have the progress of every job in the block, in place of stderr; of this thread."""
    before = _TELL.set(tell)
    try:
        yield
    finally:
        _TELL.reset(before)


class PlainMeter:
    """Progress as lines of text, one at most every `SECONDS_BETWEEN_LINES`, and one at the end.

    Parameters
    ----------
    title : str
    total : float
        How much there is to do in all.
    stream : text stream
    clock : callable returning seconds
    """

    def __init__(self, title: str, total: float, stream: TextIO, clock: Callable[[], float]) -> None:
        self._title, self._total = title, total
        self._stream, self._clock = stream, clock
        self._began = self._last = clock()
        self._is_over = False
        self._first: tuple[float, float] | None = None

    def show(self, done: float, note: str = "") -> None:
        """Print a line if the last one is old enough, or all is done.

        The time left goes by the rate since the first call: before it, code may be compiled or a device opened.
        """
        now = self._clock()
        since, before = self._first = self._first or (now, done)
        if self._is_over or (now - self._last < SECONDS_BETWEEN_LINES and done < self._total):
            return
        self._last, self._is_over = now, done >= self._total
        fresh, missing = done - before, self._total - done
        left = f", {_clock_text((now - since) * missing / fresh)} left" if fresh > 0 and missing > 0 else ""
        share, elapsed = 100 * done / self._total if self._total > 0 else 100, _clock_text(now - self._began)
        self.say(f"{self._title} {share:.0f} % after {elapsed}{left}{f'  {note}' if note else ''}")

    def say(self, text: str) -> None:
        """Print a line."""
        self._stream.write(f"{text}\n")
        self._stream.flush()


class _ToldMeter:
    """Progress that somebody else shows."""

    def __init__(self, tell: Callable[[float, float, str], None], title: str, total: float, start: float) -> None:
        self._tell, self._title, self._total = tell, title, total
        self.show(start)

    def show(self, done: float, note: str = "") -> None:
        """Tell it."""
        self._tell(done, self._total, note or self._title)

    def say(self, text: str) -> None:
        """Print a line."""
        sys.stderr.write(f"{text}\n")


class _BarMeter:
    """Progress as a bar of rich."""

    def __init__(self, bar: Progress, title: str, total: float, start: float) -> None:
        self._bar = bar
        self._task = bar.add_task(title, total=total, note="")
        bar.update(self._task, completed=start)

    def show(self, done: float, note: str = "") -> None:
        """Move the bar."""
        self._bar.update(self._task, completed=done, note=note)

    def say(self, text: str) -> None:
        """Print a line above the bar."""
        self._bar.console.print(text, markup=False, highlight=False)


def _clock_text(seconds: float) -> str:
    whole = round(seconds)
    hours = f"{whole // 3600}:{whole % 3600 // 60:02d}" if whole >= 3600 else str(whole // 60)
    return f"{hours}:{whole % 60:02d}"
