"""What is believed of every strip's rate, and how surely: one Gaussian over all their logarithms."""

from dataclasses import dataclass

import numpy as np

from stagectl.planning.problem import Pocket
from stagectl.planning.strips import Cut, costs

SAVED = 0.8
"""Of a type never met: a strip of k rows of a tool of G takes (k / G)^SAVED of the slot's time."""


@dataclass(frozen=True)
class Prior:
    """How far rates may be off what is believed, as standard deviations of their logarithms; 0.1 is 10 %.

    Parameters
    ----------
    common : float, 1
        What all strips share: material, depth, spindle.
    side, feed, type : float, 1
        What strips off one side, of one feed, and of one type share.
    own : float, 1
        What each has for itself.
    noise : float, 1
        Of one segment.
    optimism : float, 1
        Plans count on rates so many standard deviations below the median, so that what is not known is tried.
    """

    common: float
    side: float
    feed: float
    type: float
    own: float
    noise: float = 0.03
    optimism: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what cannot be learned from."""
        for name in ("common", "side", "feed", "type", "own", "noise", "optimism"):
            if not getattr(self, name) >= 0.0:
                raise ValueError(f"{name} is {getattr(self, name)}, must be >= 0")
        if not self.noise > 0.0:
            raise ValueError(f"noise is {self.noise}, must be > 0")


MEASURED = Prior(common=0.05, side=0.3, feed=0.05, type=0.05, own=0.05)
"""Rates that were measured; a side may have become slow."""
BELIEVED = Prior(common=0.1, side=0.1, feed=0.1, type=0.1, own=0.1, optimism=0.5)
"""Rates that may all be off by a fifth; with these scales begins who learns them (docs/planning.md)."""
UNKNOWN = Prior(common=3.0, side=0.05, feed=0.1, type=0.25, own=0.05, optimism=0.5)
"""Nothing was measured."""


def shared_covariance(types: np.ndarray, sides: np.ndarray, prior: Prior) -> np.ndarray:
    """Return the covariance of the logarithms of the rates of strips, before anything was milled.

    Parameters
    ----------
    types, sides : array of str, shape (strips,)
        Of each strip: its milling type, which begins with the feed, and the side off which it is milled.  No two strips
        have both in common.
    prior : Prior

    Returns
    -------
    array, shape (strips, strips), 1
    """
    covariance = prior.common**2 + prior.own**2 * np.eye(len(types))
    for deviation, shared in ((prior.side, sides), (prior.feed, types.astype("U1")), (prior.type, types)):
        covariance += deviation**2 * (shared[:, None] == shared)
    return np.asarray(covariance)


class RateBelief:
    """A Gaussian over the logarithms of the rates of all strips, by way and k.

    Parameters
    ----------
    pocket : Pocket
    rate : array, shape (ways, tool), s per cell
        The medians to begin with.
    prior : Prior
    """

    def __init__(self, pocket: Pocket, rate: np.ndarray, prior: Prior) -> None:
        cuts = [Cut(way, k) for way in range(len(rate)) for k in range(1, pocket.G + 1)]
        self.prior = prior
        self.mean = np.log(rate).ravel()
        self.covariance = shared_covariance(
            np.array([cut.name(pocket.G) for cut in cuts]), np.array([cut.side for cut in cuts]), prior
        )

    @property
    def deviation(self) -> np.ndarray:
        """Standard deviation of each logarithm, shape (ways x tool,), 1."""
        return np.asarray(np.sqrt(np.maximum(self.covariance.diagonal(), 0.0)))

    def observe(self, which: int, rate: float) -> None:
        """Take in that strip `which` was milled at `rate`, s per cell."""
        gain = self.covariance[:, which] / (self.covariance[which, which] + self.prior.noise**2)
        self.mean += gain * (np.log(rate) - self.mean[which])
        self.covariance -= np.outer(gain, self.covariance[which])

    def hoped_for(self) -> np.ndarray:
        """Return the rates that plans count on, shape (ways x tool,), s per cell."""
        return np.asarray(np.exp(self.mean - self.prior.optimism * self.deviation))


def measured(pocket: Pocket) -> RateBelief:
    """Return the belief that begins with the pocket's rates."""
    return RateBelief(pocket, costs(pocket).rate, MEASURED)


def believed(pocket: Pocket) -> RateBelief:
    """Return the belief that begins with the pocket's rates where all may be off: its scales are to be learned."""
    return RateBelief(pocket, costs(pocket).rate, BELIEVED)


def unknown(pocket: Pocket) -> RateBelief:
    """Return the belief of who has measured nothing: the pocket's rates are not looked at."""
    k = np.arange(1, pocket.G + 1)
    return RateBelief(pocket, np.tile((k / pocket.G) ** SAVED, (len(costs(pocket).rate), 1)), UNKNOWN)
