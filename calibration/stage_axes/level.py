"""How loud an axis is excited: from what weaker chirps moved, so that nothing goes further than it may."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

APPROACH = 3.0
"""A drive more than so many times as strong as the last is first tried at that part of itself."""
STRAIGHT, STEEPEST = 1.0, 2.5
"""Exponents of drive with which what moves may grow: hysteresis and friction let it move more than in proportion."""
HEADROOM = 0.9
"""Of a range, what is used."""


@dataclass(frozen=True)
class Step:
    """A chirp that was played, and how far it moved what may only move so far.

    Parameters
    ----------
    amplitude : float, V or m
    moved : array, shape (things,), m
        Largest deviation of each from rest.
    """

    amplitude: float
    moved: np.ndarray


def strongest(steps: Sequence[Step], room: np.ndarray) -> float:
    """Return the amplitude, in the steps' unit, at which everything moves as far as it may, by the last two steps.

    Parameters
    ----------
    steps : sequence of Step
        By rising amplitude; with one alone all is taken to move in proportion.
    room : array, shape (things,), m
        How far each may move.

    Examples
    --------
    >>> strongest([Step(1.0, np.array([2.0]))], np.array([8.0]))
    4.0
    >>> strongest([Step(1.0, np.array([1.0])), Step(2.0, np.array([4.0]))], np.array([16.0]))
    4.0
    """
    last = steps[-1]
    power = np.full(len(room), STRAIGHT)
    if len(steps) > 1:
        before = steps[-2]
        grown = np.log(last.moved / before.moved) / np.log(last.amplitude / before.amplitude)
        power = np.clip(grown, STRAIGHT, STEEPEST)
    return float(last.amplitude * np.min((room / last.moved) ** (1.0 / power)))
