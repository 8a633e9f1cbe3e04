"""Ctrl-C that ends a long job safely: the first asks, the second interrupts, the third kills."""

import os
import signal
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from threading import Thread
from types import FrameType

SIGNALS = (signal.SIGINT, signal.SIGTERM)
STDERR = 2


class Stopped(Exception):
    """A job that ended early because it was asked to; the text says where it stands and how to go on."""


class StopRequest:
    """Whether the person or the system has asked the job to stop; a long loop looks at `made`."""

    made: bool = False


Handler = Callable[[int, FrameType | None], object]


@contextmanager
def handled(numbers: Iterable[int], handler: Handler) -> Iterator[None]:
    """Have a handler take signals while the block lasts; afterwards they do what they did before.

    Only the main thread can enter.

    Parameters
    ----------
    numbers : iterable of int
        Of the signals.
    handler : callable(number, frame)
    """
    before = {number: signal.signal(number, handler) for number in numbers}
    try:
        yield
    finally:
        for number, kept in before.items():
            signal.signal(number, kept)


@contextmanager
def stoppable() -> Iterator[StopRequest]:
    """Turn SIGINT and SIGTERM into a request that the block polls, for as long as the block lasts.

    The second signal raises KeyboardInterrupt; from then on the system's own handling applies, which ends the process
    even inside compiled code.  Only the main thread can enter.
    """
    request = StopRequest()

    def handle(number: int, frame: FrameType | None) -> None:  # noqa: ARG001 (signal's own argument list)
        if request.made:
            for each in SIGNALS:
                signal.signal(each, signal.SIG_DFL)
            raise KeyboardInterrupt
        request.made = True
        with suppress(OSError):
            os.write(STDERR, b"\nstopping safely; Ctrl-C again ends at once\n")  # as a handler may: unbuffered

    with handled(SIGNALS, handle):
        yield request


@contextmanager
def on_signals(calls: Mapping[int, Callable[[], object]]) -> Iterator[None]:
    """Have signals call something while the block lasts, each in a thread of its own.

    A handler interrupts the main thread wherever it is, such as in an event's `wait` while it holds the event's lock:
    a handler that set that event itself would wait for ever.  Only the main thread can enter.

    Parameters
    ----------
    calls : mapping of int to callable()
        By the signal's number.
    """

    def handle(number: int, frame: FrameType | None) -> None:  # noqa: ARG001 (signal's own argument list)
        Thread(target=calls[number], daemon=True).start()

    with handled(calls, handle):
        yield
