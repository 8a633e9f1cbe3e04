"""What a person may ask of a running procedure by signals: to pause, to go on, to stop."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import FrameType

from rigkit.stop import StopRequest, handled, stoppable


@dataclass(eq=False)
class Requests:
    """What has been asked for; a procedure looks at it in every tick.

    Parameters
    ----------
    stopping : StopRequest
    pause : bool
    """

    stopping: StopRequest = field(default_factory=StopRequest)
    pause: bool = False

    @property
    def stop(self) -> bool:
        """Whether to stop."""
        return self.stopping.made


@contextmanager
def requests() -> Iterator[Requests]:
    """Take SIGUSR1 as a request to pause, SIGUSR2 to go on, SIGINT and SIGTERM to stop, while the block lasts.

    Only the main thread can enter.
    """
    with stoppable() as stopping:
        made = Requests(stopping)

        def handle(number: int, frame: FrameType | None) -> None:  # noqa: ARG001 (signal's own argument list)
            made.pause = number == signal.SIGUSR1

        with handled((signal.SIGUSR1, signal.SIGUSR2), handle):
            yield made
