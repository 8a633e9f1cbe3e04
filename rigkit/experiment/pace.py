"""Keeps a simulation to the clock on the wall, and counts where it could not."""

import time
from collections.abc import Callable


class Pace:
    """Waits until a sample is due.  What was missed is not made up for: a slow machine simulates slowly.

    Parameters
    ----------
    rate : float, samples/s
    now : callable() -> float, s, a monotonic clock
    sleep : callable(float, s)

    Attributes
    ----------
    late : int
        Times that a sample was due already.
    behind : float, s
        By which the simulation is behind the clock, in all.
    """

    def __init__(
        self, rate: float, now: Callable[[], float] = time.monotonic, sleep: Callable[[float], None] = time.sleep
    ) -> None:
        self.late, self.behind = 0, 0.0
        self._rate, self._now, self._sleep = rate, now, sleep
        self._start: float | None = None

    def restart(self) -> None:
        """Count the samples of another graph from now on; what was late stays counted."""
        self._start = None

    def until(self, sample: int) -> None:
        """Return when that sample, counted from 0, is due."""
        if self._start is None:
            self._start = self._now() - self.behind - sample / self._rate
        ahead = self._start + self.behind + sample / self._rate - self._now()
        if ahead >= 0:
            self._sleep(ahead)
        else:
            self.late += 1
            self.behind -= ahead
