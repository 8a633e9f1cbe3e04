"""Whether channels are inverted or exchanged, as far as signals show it, and how sure that is."""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations, permutations, product

import numpy as np

from vibractl.foreign.search import correlations
from vibractl.learning.laws import SIGNIFICANT

SURE = 0.99
"""Confidence from which something is taken for so."""
TOGETHER = 2.0
"""Hz over which a model, or a vibrator without one, errs by the same: so many independent witnesses has a band."""
MANY = 6
"""Orders of channels that are all tried; of more, exchanges of two channels alone."""

Wires = tuple[tuple[int, int], ...]
"""Of each channel, which of those given it is, counted from 0, and its sign."""


@dataclass(frozen=True)
class Sign:
    """The polarity of one channel.

    Parameters
    ----------
    correlation : float, -1 to 1
        The larger of the two in size, where it is largest.
    confidence : float, 0.5 to 1
        That its sign is right.
    """

    correlation: float
    confidence: float

    @property
    def is_inverted(self) -> bool:
        """Whether it is, as it seems."""
        return self.correlation < 0

    @property
    def is_sure(self) -> bool:
        """Whether that can be told."""
        return self.confidence >= SURE


@dataclass(frozen=True)
class Exchange:
    """How channels are wired.

    Parameters
    ----------
    wires : Wires
        As it seems; signs are those against the first one.
    confidence : float, 0.5 to 1
        That this is so: against the wires as given or, where it is these, against the best other ones.
    """

    wires: Wires
    confidence: float

    @property
    def is_other(self) -> bool:
        """Whether they seem to be wired otherwise than given."""
        return self.wires != straight(len(self.wires))

    @property
    def is_sure(self) -> bool:
        """Whether that can be told."""
        return self.confidence >= SURE


def straight(channels: int) -> Wires:
    """Return the wires as given."""
    return tuple((channel, 1) for channel in range(channels))


def wired(signal: np.ndarray, wires: Wires) -> np.ndarray:
    """Return a signal (samples, channels), any unit, with other wires."""
    found: np.ndarray = signal[:, [channel for channel, _ in wires]] * np.array([sign for _, sign in wires])
    return found


def witnesses(reference: np.ndarray, rate: float) -> float:
    """Return how many independent parts a reference's own band has.

    Parameters
    ----------
    reference : array, shape (frames, sides), any unit
    rate : float, samples/s
    """
    size = np.abs(np.fft.rfft(reference, axis=0)).max(axis=1)
    width = np.count_nonzero(size > SIGNIFICANT * size.max()) * rate / len(reference)
    return max(1.0, width / TOGETHER)


def confidence(better: float, worse: float, parts: float) -> float:
    """Return how sure it is that the explanation with the better correlation is the right one of two.

    Parameters
    ----------
    better, worse : float, 0 to 1
        Correlations of what is explained with what is heard.
    parts : float
        Independent witnesses.

    Source
    ------
    The ratio of the Gaussian likelihoods of what either leaves unexplained; Kay 1998, Fundamentals of Statistical
    Signal Processing: Detection Theory, sec. 3.3.
    """
    unexplained = [max(1.0 - each**2, 1e-12) for each in (better, worse)]
    ratio = parts * math.log(unexplained[1] / unexplained[0])
    return 1 / (1 + math.exp(-min(ratio, 500.0)))


def signs(expected: np.ndarray, heard: np.ndarray, parts: float) -> tuple[Sign, ...]:
    """Return the polarity of each channel.

    Parameters
    ----------
    expected : array, shape (frames, channels), any unit
    heard : array, shape (at least frames, channels), any unit
    parts : float
        Independent witnesses.
    """
    found = []
    for one, other in zip(expected.T, heard.T, strict=True):
        like = correlations(one, other[:, None])[:, 0]
        upright, inverted = max(float(like.max()), 0.0), max(-float(like.min()), 0.0)
        better, worse = max(upright, inverted), min(upright, inverted)
        found.append(Sign(better if upright >= inverted else -better, confidence(better, worse, parts)))
    return tuple(found)


def exchanges(
    likeness: Callable[[Wires, Wires], float], drives: int, responses: int, parts: float
) -> tuple[Exchange, Exchange]:
    """Return how drives and responses are wired.

    Parameters
    ----------
    likeness : callable(wires of drives, of responses) -> float, 0 to 1
        Correlation of what is expected then with what is heard, whatever the sign of each response.
    drives, responses : int, channels
    parts : float
        Independent witnesses.
    """
    found = {
        (tuple(zip(order, signs, strict=True)), tuple((channel, 1) for channel in other)): 0.0
        for order in _orders(drives)
        for signs in product((1,), *((1, -1),) * (drives - 1))
        for other in _orders(responses)
    }
    for wires in found:
        found[wires] = likeness(*wires)
    return _best(found, 0, drives, parts), _best(found, 1, responses, parts)


def exchange(likeness: Callable[[Wires], float], channels: int, parts: float) -> Exchange:
    """Return in which order channels are.

    Parameters
    ----------
    likeness : callable(wires) -> float, 0 to 1
        Correlation with what they should be, whatever the sign of each.
    channels : int
    parts : float
        Independent witnesses.
    """
    return exchanges(lambda _, wires: likeness(wires), 1, channels, parts)[1]


def _best(found: Mapping[tuple[Wires, Wires], float], which: int, channels: int, parts: float) -> Exchange:
    best: dict[Wires, float] = {}
    for wires, like in found.items():
        best[wires[which]] = max(best.get(wires[which], 0.0), like)
    given = straight(channels)
    first = max(best, key=lambda wires: best[wires])
    others = [like for wires, like in best.items() if wires != first]
    if not others:
        return Exchange(given, 1.0)
    sure = confidence(best[first], best[given] if first != given else max(others), parts)
    return Exchange(first, sure)


def _orders(channels: int) -> Iterator[tuple[int, ...]]:
    given = tuple(range(channels))
    if math.factorial(channels) <= MANY:
        yield from permutations(given)
        return
    yield given
    for one, other in combinations(given, 2):
        turned = list(given)
        turned[one], turned[other] = other, one
        yield tuple(turned)
