"""A number that was found in a recording, and how far it may be off."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

MOST_DIGITS = 4
CERTAIN = 3.0
"""Standard deviations from which a number is told from zero."""


@dataclass(frozen=True)
class Estimate:
    """A number with one standard deviation by noise, and one that a misfit of what it is compared with may make.

    Parameters
    ----------
    value, noise, misfit : float, any unit
    """

    value: float
    noise: float
    misfit: float = 0.0

    @property
    def error(self) -> float:
        """Both together; the misfit, which few parts of a shot tell, twice."""
        return math.hypot(self.noise, 2 * self.misfit)

    @property
    def is_told(self) -> bool:
        """Whether it is not zero for all that is known."""
        return abs(self.value) > CERTAIN * self.error

    def moved(self, by: float) -> "Estimate":
        """Return it with a known number added."""
        return Estimate(self.value + by, self.noise, self.misfit)

    def times(self, factor: float) -> "Estimate":
        """Return it in another unit."""
        return Estimate(factor * self.value, factor * self.noise, factor * self.misfit)

    @property
    def text(self) -> str:
        """It in words, with two digits of the error.

        Examples
        --------
        >>> Estimate(36.12, 190.0).text, Estimate(0.0041, 0.0056).text
        ('36 +- 190', '0.0041 +- 0.0056')
        """
        digits = min(max(1 - math.floor(math.log10(self.error)), 0), MOST_DIGITS) if self.error > 0 else 2
        return f"{self.value:.{digits}f} +- {self.error:.{digits}f}"


def mean(found: Sequence[Estimate]) -> Estimate:
    """Return the mean of estimates of one number: noise averages, a misfit that they share does not."""
    weight = np.array([1 / max(each.error, 1e-12) ** 2 for each in found])
    weight /= weight.sum()
    value = float(weight @ [each.value for each in found])
    noise = math.sqrt(float(weight**2 @ [each.noise**2 for each in found]))
    return Estimate(value, noise, float(weight @ [each.misfit for each in found]))


def slope(place: Sequence[float], found: Sequence[Estimate]) -> Estimate:
    """Return by how much a number grows from place to place; misfits count as independent.

    Parameters
    ----------
    place : sequence of float, any unit
    found : sequence of Estimate, as many, at least 2
    """
    weight = np.array([1 / max(each.error, 1e-12) ** 2 for each in found])
    lever = np.asarray(place) - float(weight @ np.asarray(place)) / weight.sum()
    pull = weight * lever / float(weight @ lever**2)
    value = float(pull @ [each.value for each in found])
    parts = [[each.noise for each in found], [each.misfit for each in found]]
    noise, misfit = (math.sqrt(float(pull**2 @ np.square(part))) for part in parts)
    return Estimate(value, noise, misfit)
