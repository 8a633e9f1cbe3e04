"""How late this machine wakes a thread that waits for a moment, as cyclictest measures it."""

import os
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rigkit.priority import real_time, undisturbed


@dataclass(frozen=True, eq=False)
class WakeUps:
    """What was seen.

    Parameters
    ----------
    late : array, shape (times,), s
        After the moment that was waited for; a moment that was missed as a whole counts as well.
    period : float, s
        From one to the next.
    """

    late: np.ndarray
    period: float

    @property
    def worst(self) -> float:
        """The latest, s."""
        return float(self.late.max())

    def quantile(self, share: float) -> float:
        """Return the lateness that so large a part stayed below, s."""
        return float(np.quantile(self.late, share))

    def beyond(self, limit: float) -> int:
        """Return how many were later than that, s."""
        return int((self.late > limit).sum())


def wake_ups(
    period: float,
    seconds: float,
    show: Callable[[float], object] = lambda _: None,
    now: Callable[[], float] = time.monotonic,
    sleep: Callable[[float], None] = time.sleep,
) -> WakeUps:
    """Wait for one moment after another, with what priority a live run has, and see how late each was.

    Parameters
    ----------
    period : float, s
    seconds : float, s
    show : callable(float)
        Told now and then how long it has been, s.
    now : callable() -> float, s, a monotonic clock
    sleep : callable(float, s)
    """
    times = max(1, round(seconds / period))
    late, shown = np.zeros(times), max(1, round(0.25 / period))
    with undisturbed(), real_time():
        begin = now()
        for number in range(times):
            due = begin + (number + 1) * period
            if (ahead := due - now()) > 0:
                sleep(ahead)
            late[number] = now() - due
            if (number + 1) % shown == 0:
                show((number + 1) * period)
    return WakeUps(late, period)


def is_real_time_granted() -> bool:
    """Whether this program may have real-time priority."""
    with real_time():
        policy = getattr(os, "sched_getscheduler", lambda _: 0)(0)
        return bool(policy & ~getattr(os, "SCHED_RESET_ON_FORK", 0))
