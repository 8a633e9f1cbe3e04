"""How large a controller's gains may be above `Outer.reach`, where no model holds."""

from dataclasses import dataclass

import numpy as np

from stagectl.config import Outer, PerAxis

BINS = 40
"""Frequencies at which they are looked at: 6 to 9 % apart."""


@dataclass(frozen=True, eq=False)
class AllowedGains:
    """Largest gains of a controller, re the plant at rest.

    Parameters
    ----------
    feedback : array, shape (bins,), 1
        From the error, at each of `frequencies_above`.
    forward : array, shape (bins,), 1
        From the reference.
    """

    feedback: np.ndarray
    forward: np.ndarray


def frequencies_above(outer: Outer, rate: float) -> np.ndarray:
    """Return frequencies from `Outer.reach` to half the rate, shape (bins,), Hz; none where there are none.

    Parameters
    ----------
    outer : Outer
    rate : float, samples/s
    """
    return np.geomspace(outer.reach, rate / 2, BINS) if outer.reach < rate / 2 else np.zeros(0)


def configured(outer: Outer, axis: int, rate: float, chosen: float = 0.0) -> AllowedGains:
    """Return the same gains for all frequencies, those of `[outer]`.

    Parameters
    ----------
    outer : Outer
    axis : int, counted from 0
    rate : float, samples/s
    chosen : float, 1, optional
        `Weights.beyond` of a loop that was chosen: in place of the gain from the error, where there is one.
    """
    same = np.ones(len(frequencies_above(outer, rate)))
    beyond = of_axis(outer.beyond, axis)
    if outer.allowed:
        beyond = min(beyond, of_axis(outer.allowed, axis))
    return AllowedGains((chosen or beyond) * same, outer.forward_beyond * same)


def of_axis(values: PerAxis, axis: int) -> float:
    """Return the setting of an axis: there is one for all, or one an axis."""
    return values[axis % len(values)]
