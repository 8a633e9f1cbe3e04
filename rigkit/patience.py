"""How long to wait for something that makes progress, on a machine of any speed."""

import math
import os
import time
from collections.abc import Callable
from pathlib import Path

LOOK = 0.1
"""s that one look counts at most: while this program stood still itself, it has not waited."""


class Patience:
    """Is over when there was no progress for a time in which one has looked often.

    Parameters
    ----------
    seconds : float, s, > 0
    step : float, unit of the progress, > 0
        What counts as progress.
    clock : callable() -> float, s
    """

    def __init__(self, seconds: float, step: float, clock: Callable[[], float] = time.monotonic) -> None:
        self._seconds, self._step, self._clock = seconds, step, clock
        self._reached, self._waited, self._looked = -math.inf, 0.0, clock()

    def is_over(self, progress: float) -> bool:
        """Look: `progress` is a number that grows, such as a count or `processor_time`."""
        now = self._clock()
        self._waited += min(now - self._looked, LOOK)
        self._looked = now
        if progress >= self._reached + self._step:
            self._reached, self._waited = progress, 0.0
        return self._waited > self._seconds


def processor_time(process: int) -> float:
    """Return the processor time that a process has used, s; 0 where the system does not tell."""
    try:
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
