"""A column of time: whether it rises evenly, and at which rate."""

from dataclasses import dataclass

import numpy as np

from ctlblocks.recording import RecordingError

TIME = ("t", "time", "zeit", "tid", "seconds", "timestamp", "timestamps", "x_value")
"""Names, in small letters and without a unit, of a column that holds the time; also with "_s", "_ms", "_us" behind."""

SECONDS = {"1": 1.0, "s": 1.0, "sec": 1.0, "seconds": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "μs": 1e-6, "ns": 1e-9}
"""What a unit of time is in s."""

STEADY = 1e-3
"""Part by which two rates that are said of one file may differ."""

UNEVEN = 0.5
"""Part of a sample period by which a step of time may be too long or too short: rounded, but no sample lost."""


def seconds_of(name: str, unit: str) -> float | None:
    """Return what 1 in a column is in s; None where it does not hold the time, or in a unit that is none of time.

    Parameters
    ----------
    name, unit : str
        As its head says; "1" for no unit.

    Examples
    --------
    >>> seconds_of("Time", "ms"), seconds_of("t_us", "1"), seconds_of("force", "s")
    (0.001, 1e-06, None)
    """
    plain, _, last = name.lower().rpartition("_")
    if plain in TIME and last in SECONDS and unit == "1":
        return SECONDS[last]
    return SECONDS.get(unit) if name.lower() in TIME else None


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
            self._first, self._last, self._row = float(time[0]), float(time[0]), int(places[0])
            rows, steps = places[1:], np.diff(time)
        else:
            rows, steps = places, np.diff(time, prepend=self._last)
        if len(steps):
            self._period = self._period or float(steps.mean())
            if not (np.abs(steps - self._period) <= UNEVEN * self._period).all() or not self._period > 0:
                self._refuse(rows, time[-len(steps) :], steps)
        self._last, self._row, self.frames = float(time[-1]), int(places[-1]), self.frames + len(time)

    def rate(self) -> float:
        """Return the rate, samples/s.

        Raises
        ------
        RecordingError : a single sample has none.
        """
        if self.frames < 2:
            raise RecordingError(f"{self.name}: has {self.frames} {self.place}, must have at least 2 to tell the rate")
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
