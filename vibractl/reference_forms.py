"""The references that are asked for by a word and numbers: a function and a line of `FORMS` each."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

ALIGNED = 1e-6
"""Hz, how near a sine must be to a multiple of 1/T."""


@dataclass(frozen=True)
class Form:
    """A form of reference.

    Parameters
    ----------
    numbers : tuple of str
        Names of its numbers, frequencies in Hz, the last one its length in s.
    shape : callable(time, numbers) -> array
        Its signal of amplitude 1 at times, shape (frames,), s.
    root : callable(numbers) -> float or None, Hz
        The frequency of which it has the multiples only, if there is one; ValueError where it does not fit the length.
    is_one_tone : bool
        Whether it is one tone at each time: then a report shows that tone's overtones and phase.
    sweep : callable(numbers) -> (float, float) or None, Hz
        First and last frequency, where it is a linear sweep between them: what SEG-Y headers say.
    """

    numbers: tuple[str, ...]
    shape: Callable[[np.ndarray, Sequence[float]], np.ndarray]
    root: Callable[[Sequence[float]], float | None] = lambda _: None
    is_one_tone: bool = False
    sweep: Callable[[Sequence[float]], tuple[float, float] | None] = lambda _: None


def _chirp(time: np.ndarray, numbers: Sequence[float]) -> np.ndarray:
    first, last, seconds = numbers
    return np.asarray(np.sin(2 * np.pi * (first * time + (last - first) / (2 * seconds) * time**2)))


def _sine(time: np.ndarray, numbers: Sequence[float]) -> np.ndarray:
    return np.asarray(np.sin(2 * np.pi * numbers[0] * time))


def _root_of_sine(numbers: Sequence[float]) -> float:
    root, seconds = numbers
    if abs(root * seconds - round(root * seconds)) > ALIGNED * seconds:
        nearest = round(root * seconds) / seconds
        raise ValueError(f"{root:g} Hz is no multiple of 1/{seconds:g} s; the nearest is {nearest:g}")
    return root


FORMS = {
    "chirp": Form(("F0", "F1", "SECONDS"), _chirp, is_one_tone=True, sweep=lambda numbers: (numbers[0], numbers[1])),
    "sine": Form(("F0", "SECONDS"), _sine, _root_of_sine, True, lambda numbers: (numbers[0], numbers[0])),
}


def written(name: str) -> str:
    """Return how a reference of a form is asked for."""
    return ":".join((name, *FORMS[name].numbers))


def choices(file: str) -> str:
    """Return all that a reference may be, a file in these words.

    Examples
    --------
    >>> choices("a file")
    'chirp:F0:F1:SECONDS, sine:F0:SECONDS, or a file'
    """
    return f"{', '.join(map(written, FORMS))}, or {file}"
