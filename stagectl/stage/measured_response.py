"""What an axis was heard to do, frequency by frequency: no model, and so nothing that a model misses."""

from dataclasses import dataclass

import numpy as np

from stagectl.stage.state_feedback import StateFeedback

SMALL = 0.5
"""Largest gain of a loop where no model knows its phase: whatever that is, Ms is 2 at most."""


@dataclass(frozen=True, eq=False)
class MeasuredResponse:
    """Frequency responses from the inner loop's reference (m), 0 where noise hid them.

    Parameters
    ----------
    frequency : array, shape (cells,), Hz
        Rising.
    position : complex array, shape (cells,), m/m
        To the axis' position.
    seen : complex array, shape (cells,), m/m
        To what a deflection's compensation takes for the robot's motion: what laser and plate's sensor see differently.

    Raises
    ------
    ValueError : shapes differ, frequencies do not rise, or something is not finite.
    """

    frequency: np.ndarray
    position: np.ndarray
    seen: np.ndarray

    def __post_init__(self) -> None:
        """Check."""
        if self.frequency.ndim != 1 or not self.frequency.shape == self.position.shape == self.seen.shape:
            shapes = ", ".join(str(each.shape) for each in (self.frequency, self.position, self.seen))
            raise ValueError(f"a measured response has the shapes {shapes}, must be (cells,) three times")
        if not all(np.isfinite(each).all() for each in (self.frequency, self.position, self.seen)):
            raise ValueError("a measured response is not finite everywhere")
        if not (np.diff(self.frequency, prepend=0.0) > 0).all():
            raise ValueError("a measured response's frequencies must be > 0 and rise")

    def answers(self, loop: StateFeedback) -> "MeasuredLoop":
        """Return what an outer loop around this would do.

        Parameters
        ----------
        loop : StateFeedback
        """
        rate = loop.model.rate
        feedback, reference = (each.response(self.frequency, rate) for each in (loop.system(), loop.reference_system()))
        sensitivity = 1.0 / (1.0 + feedback * self.position)
        led = sensitivity * reference
        return MeasuredLoop(*(np.abs(each) for each in (sensitivity, led * self.position, led * self.seen)))


@dataclass(frozen=True, eq=False)
class MeasuredLoop:
    """What an outer loop does, by what was heard of its plant.

    Parameters
    ----------
    sensitivity : array, shape (cells,), 1
        1 where noise hid it.
    answer : array, shape (cells,), 1
        To a reference; 0 where noise hid it.
    compensation : array, shape (cells,), 1
        Gain of the loop that a deflection's compensation is: what laser and plate's sensor see differently of the
        plate's own motion is taken for the robot's and becomes reference.  Stable, whatever the phase, below one.
    """

    sensitivity: np.ndarray
    answer: np.ndarray
    compensation: np.ndarray


def near(cells: np.ndarray, frequency: np.ndarray, spread: float, width: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the first cell near each of some frequencies, and the one after the last: two of shape (bins,).

    Parameters
    ----------
    cells : array, shape (cells,), Hz
        Rising.
    frequency : array, shape (bins,), Hz
    spread : float, 1
        How far away still counts, of the frequency.
    width : float, Hz
        And more below.
    """
    low = np.searchsorted(cells, frequency * (1 - spread) - width)
    return low, np.searchsorted(cells, frequency * (1 + spread), side="right")
