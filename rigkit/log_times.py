"""Times at which messages were logged: whether they are those of even samples, and at which rate."""

from dataclasses import dataclass

import numpy as np

from ctlblocks.recording import RecordingError
from rigkit.even_time import STEADY, UNEVEN

ERRORS = 4.0
"""Standard errors by which a rate that is said may lie off what the times say, where they jitter."""


@dataclass(frozen=True)
class EvenLog:
    """The even samples that messages were logged at.

    Parameters
    ----------
    start : float, s
        When the first of them was.
    period : float, s
    frames : int
    """

    start: float
    period: float
    frames: int

    @classmethod
    def of(cls, name: str, time: np.ndarray, rate: float | None) -> "EvenLog":
        """Return the even samples nearest to the times of a log: by least squares, or of a rate that fits as well.

        Parameters
        ----------
        name : str
            Of the file and of what was logged, for errors.
        time : array, shape (messages,), s
        rate : float or None, samples/s
            As it is said.

        Raises
        ------
        RecordingError : fewer than two messages, or one that is half a sample away from where it should be.
        """
        if len(time) < 2:
            raise RecordingError(f"{name} has {len(time)} messages, must have at least 2 to tell the rate")
        _refuse_uneven(name, np.diff(time))
        from_middle = np.arange(len(time)) - (len(time) - 1) / 2
        square = float(from_middle @ from_middle)
        period = float(from_middle @ (time - time.mean())) / square
        start, jitter = _fitted(time, period)
        if not jitter < UNEVEN * period:
            raise RecordingError(
                f"{name} was not logged evenly, must be to half a sample: times are up to {jitter:.6g} s off those of "
                f"{1 / period:.9g} samples/s (jitter, or samples are missing)"
            )
        if rate is not None:
            error = float(np.std(time - time.mean() - period * from_middle)) / np.sqrt(square)
            said, off = _fitted(time, 1 / rate)
            if abs(1 / rate - period) <= max(STEADY * period, ERRORS * error) and off < UNEVEN / rate:
                return cls(said, 1 / rate, len(time))
        return cls(start, period, len(time))


def _fitted(time: np.ndarray, period: float) -> tuple[float, float]:
    """Return when even samples of a period begin, s, and how far from them the times are at most, s."""
    late = time - period * np.arange(len(time))
    return float(late.min() + late.max()) / 2, float(late.max() - late.min()) / 2


def _refuse_uneven(name: str, steps: np.ndarray) -> None:
    usual = float(np.median(steps))
    wrong = ~(np.abs(steps - usual) <= UNEVEN * usual) | (steps <= 0)
    if not wrong.any():
        return
    at = int(wrong.argmax())
    raise RecordingError(
        f"{name} was not logged evenly, must be to half a sample: {wrong.sum()} of {len(steps)} steps of time are off, "
        f"{steps.min():.6g} to {steps.max():.6g} s where most are {usual:.6g} s, the first to message {at + 2} "
        "(jitter, or samples are missing)"
    )
