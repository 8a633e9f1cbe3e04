"""A column of time: whether it rises evenly, and at which rate."""

from dataclasses import dataclass

import numpy as np

from ctlblocks.recording import RecordingError

TIME = ("t", "time", "zeit", "tid", "seconds")
"""Names, in small letters and without a unit, of a column that holds the time."""

SECONDS = {"1": 1.0, "s": 1.0, "sec": 1.0, "seconds": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "μs": 1e-6, "ns": 1e-9}
"""What a unit of time is in s."""

UNEVEN = 0.5
"""Part of a sample period by which a step of time may be too long or too short: rounded, but no sample lost."""


def is_time(name: str) -> bool:
    """Whether a column of this name holds the time."""
    return name.lower() in TIME


@dataclass
class EvenTime:
    """Follows a column of time through a file, block by block.

    Parameters
    ----------
    name : str
        Of the file and of the column, for errors.
    scale : float, s
        What its unit is.
    place : str
        What its values are counted in: "row" or "sample".
    """

    name: str
    scale: float
    place: str
    _first: float = 0.0
    _last: float = 0.0
    _row: int = 0
    _period: float = 0.0
    frames: int = 0

    def follow(self, places: np.ndarray, time: np.ndarray) -> None:
        """Take what comes next.

        Parameters
        ----------
        places : int array, shape (frames,)
            Where in the file each value stands.
        time : array, shape (frames,), the column's unit

        Raises
        ------
        RecordingError : it does not rise in even steps.
        """
        if len(time) == 0:
            return
        time = time * self.scale
        if self.frames == 0:
            self._first = self._last = time[0]
            self._row = int(places[0])
            self._period = float(time[-1] - time[0]) / (len(time) - 1) if len(time) > 1 else 0.0
        steps = np.diff(time, prepend=self._last)
        if self.frames == 0:
            steps[0] = self._period
        elif self._period == 0.0:
            self._period = float(steps[0])
        uneven = ~(np.abs(steps - self._period) <= UNEVEN * self._period) | (steps <= 0)
        if uneven.any():
            self._refuse(places, time, steps)
        self._last, self._row, self.frames = float(time[-1]), int(places[-1]), self.frames + len(time)

    def rate(self) -> float:
        """Return the rate, samples/s.

        Raises
        ------
        RecordingError : a single sample has none.
        """
        if self.frames < 2:
            raise RecordingError(
                f"{self.name}: has {self.frames} row of numbers, must have at least 2 to tell the rate"
            )
        return 1 / ((self._last - self._first) / (self.frames - 1))

    def _refuse(self, places: np.ndarray, time: np.ndarray, steps: np.ndarray) -> None:
        usual = float(np.median(steps))
        wrong = ~(np.abs(steps - usual) <= UNEVEN * usual) | (steps <= 0)
        at = int(wrong.argmax())
        before, step = self._row if at == 0 else int(places[at - 1]), float(steps[at])
        what = (
            "the same time again" if step == 0 else "time goes back" if step < 0
            else "samples are missing" if step > usual else "an uneven step"
        )  # fmt: skip
        raise RecordingError(
            f"{self.name} does not rise in even steps, must be sampled evenly: {self.place} {places[at]} is "
            f"{time[at]:.9g} s, {step:.6g} s after {self.place} {before}, most steps are {usual:.6g} s ({what})"
        )
