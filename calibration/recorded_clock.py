"""How responses lie in time beside drives: a lag, a clock that runs faster, a record that is late beside others."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Self

import numpy as np
from scipy.optimize import minimize_scalar

from calibration.recorded_sum import Sum

LARGEST = 300e-6
"""1: clocks of two devices differ by less; a tenth of that is usual."""
SURE = 4.0
"""By so many standard deviations a difference must stand out to be told."""
SHOWN = 5.0
"""By so many of its standard deviations, were there nothing but noise, the log likelihood must depend on a difference,
or the recordings do not show it."""
STRONG, FEWEST = 1e-3, 8
"""Of the strongest line, in power over noise, from where on a line is looked at, and lines that there must be."""
RIDGE = 1e-6
"""Of the strongest combination of drives: weaker ones are not looked at."""
SPREAD = 0.02
"""Of all the time, by which the times scatter at which a line is excited, or it does not show a difference: a single
sweep does not, for each of its frequencies comes once."""
FIRST, FURTHER = 16, 4
"""Blocks that a clock is first found from, and by how many times more from step to step: what is known of it by then
keeps its phase from going around."""
STEP = 0.2
"""Cycles of the highest line, from one place that is tried to the next."""
NEAR = 0.25
"""Of its largest, in power, from where on a correlation counts as strong."""
ALIKE = 20.0
"""Times its median, that a correlation must have at its peak for a lag to be believed."""


PASSES = 4
"""At most."""
SMALLEST_PART = 0.1
"""Of the rest of a clock that a pass is believed to show."""


@dataclass(frozen=True)
class Turn:
    """A number by which phases turn, as it is found.

    Parameters
    ----------
    value, error : float
        And one standard deviation; infinite where the recordings do not show it.
    """

    value: float
    error: float

    @property
    def is_told(self) -> bool:
        """Whether it stands out."""
        return abs(self.value) > SURE * self.error

    @property
    def ppm(self) -> str:
        """A difference of clocks with its error, in words."""
        return f"{1e6 * self.value:.2f} ppm (+- {1e6 * self.error:.2g})"


UNKNOWN = Turn(0.0, float("inf"))


class Passes:
    """A clock that is found in passes, each with what is known of it taken out.

    A block counts at its middle.  Sweeps that lie elsewhere in it are nearer to each other than the blocks' middles are
    apart, and what is left of a clock seems smaller than it is: two passes tell by how much.
    """

    def __init__(self) -> None:
        self.drift = UNKNOWN
        self._part, self._before = 1.0, (0.0, UNKNOWN)

    def take(self, applied: float, shown: Turn) -> Turn:
        """Take what a pass has shown with so much taken out; return what is still to be."""
        first, left = self._before
        if abs(applied - first) > SURE * max(left.error, shown.error):
            found = (left.value - shown.value) / (applied - first)
            self._part = found if SMALLEST_PART <= found <= 1 / SMALLEST_PART else self._part
        rest, self._before = Turn(shown.value / self._part, shown.error / self._part), (applied, shown)
        if np.isfinite(rest.error):
            self.drift = Turn(applied + rest.value, rest.error)
        return rest


@dataclass(frozen=True)
class Stack:
    """Normal equations whose responses may have phases that differ from part to part.

    Parameters
    ----------
    total : Sum
        Of all parts.
    right : complex array, shape (parts, lines, outputs, k)
        Of each part.
    """

    total: Sum
    right: np.ndarray

    @classmethod
    def of(cls, parts: Iterable[Sum]) -> Self:
        """Add parts up."""
        first, *others = parts
        rights, total = [first.right], first.copy()
        for other in others:
            rights.append(other.right)
            total = total.added(other)
        return cls(total, np.stack(rights))


def lag(drive: np.ndarray, response: np.ndarray, ringing: int) -> int | None:
    """Return by how many samples responses come after drives, where they are most alike; negative: before.

    Parameters
    ----------
    drive : array, shape (samples, inputs), any unit
    response : array, shape (samples, outputs), any unit
    ringing : int, samples
        By which the strongest part of an impulse response may come after its beginning.

    Returns
    -------
    int or None
        Where the impulse response begins to be strong: where the correlation of drives, whitened, with responses first
        comes near its largest; None where nothing stands out.  Of several that are nearly as strong, as of a sweep that
        is repeated, one within `ringing` of none.
    """
    if not drive.any():
        return None
    points = len(drive) + len(response)
    sent, heard = np.fft.rfft(drive, points, axis=0), np.fft.rfft(response, points, axis=0)
    power = (np.abs(sent) ** 2).sum(axis=1, keepdims=True)
    white = sent / (power + 1e-3 * power.max())
    size = np.zeros(points)
    for one in white.T:
        for other in heard.T:
            size += np.fft.irfft(other * np.conj(one), points) ** 2
    found = int(size.argmax())
    if not size[found] > ALIKE * np.median(size):
        return None
    near = np.arange(-ringing, ringing + 1) % points
    if size[near].max() >= NEAR * size[found]:  # one sweep is like the next
        found = int(near[size[near].argmax()])
    before = size[np.arange(found - ringing, found + 1) % points]
    found += int(np.argmax(before >= NEAR * size[found])) - ringing
    return found if found < len(response) else found - points


def clock(parts: Callable[[int], Iterable[Sum]], middles: np.ndarray, wanted: np.ndarray) -> Turn:
    """Find by how much the recorder's clock is faster than the player's.

    Parameters
    ----------
    parts : callable(int) -> iterable of Sum
        So many blocks from the beginning on, each by itself.
    middles : array, shape (blocks,), s
        When each was.
    wanted : array, shape (lines,), Hz
        Of their equations.

    Returns
    -------
    Turn
        1: not ppm.
    """
    count, middle, most = FIRST, 0.0, LARGEST
    while True:
        lever = middles[:count]
        if len(lever) < 2:
            return UNKNOWN
        found = turned(Stack.of(parts(len(lever))), lever, wanted, middle - most, middle + most)
        if count >= len(middles):
            return found
        if np.isfinite(found.error):
            step = STEP / (wanted[-1] * float(np.ptp(lever)))
            middle, most = found.value, min(most, max(2 * SURE * found.error, step))
        count *= FURTHER


def turned(stack: Stack, lever: np.ndarray, wanted: np.ndarray, low: float, high: float) -> Turn:
    """Find the number x that, responses turned by exp(2 pi j f x lever), leaves least of them unexplained.

    Parameters
    ----------
    stack : Stack
    lever : array, shape (parts,), any unit
    wanted : array, shape (lines,), Hz
        Of the equations; farther apart than these reach.
    low, high : float, s per unit of lever
        Between which it is looked for.
    """
    stack, wanted = _excited(stack, wanted)
    if len(wanted) < FEWEST:
        return UNKNOWN
    power, (scaled, size) = stack.total.power, stack.total.scaled()
    coefficients = size.shape[-1]
    lower = np.linalg.inv(np.linalg.cholesky(scaled + RIDGE * np.eye(coefficients)))
    share = np.einsum("loij,bloj->bloi", lower, stack.right / size)
    free = np.maximum(stack.total.rows - coefficients, 0.0)[:, None]
    if not free.any() or not _is_at_several(share, lever):
        return UNKNOWN

    def left(x: float, lines: slice = slice(None)) -> float:
        turn = np.exp(2j * np.pi * x * wanted[lines] * lever[:, None])
        explained = (np.abs(np.einsum("bl,bloi->loi", turn, share[:, lines])) ** 2).sum(axis=2)
        rest = np.maximum(power[lines] - explained, 1e-12 * power[lines] + np.finfo(float).tiny)
        return float((free[lines] * np.log(rest)).sum())

    step = STEP / (wanted[-1] * float(np.ptp(lever)))
    places = np.linspace(low, high, 2 * max(int(np.ceil((high - low) / step / 2)), 2) + 1)
    cost = np.array([left(place) for place in places])
    best = int(cost.argmin())
    if not float(np.median(cost)) - cost[best] >= SHOWN * np.sqrt(size.size):
        return UNKNOWN
    found = _least(left, places[max(best - 1, 0)], places[min(best + 1, len(places) - 1)], step)
    middle = int(np.searchsorted(np.cumsum(wanted**2), 0.5 * (wanted**2).sum()))
    halves = slice(0, middle), slice(middle, None)
    return _agreed(
        found, [_least(partial(left, lines=each), found.value - step, found.value + step, step) for each in halves]
    )


def _least(cost: Callable[[float], float], low: float, high: float, step: float) -> Turn:
    """Find where a cost is least, and by its bend how well that is known."""
    found = minimize_scalar(cost, bounds=(low, high), method="bounded", options={"xatol": 1e-4 * step})
    side = step / 8
    bend = (cost(found.x + side) + cost(found.x - side) - 2 * found.fun) / side**2
    return Turn(float(found.x), float(1 / np.sqrt(bend)) if bend > 0 else float("inf"))


def _agreed(found: Turn, halves: Sequence[Turn]) -> Turn:
    """Return a number with the error that two halves of the lines show, where they differ by more than theirs.

    A clock turns all lines alike; resonances that move with the level, or as the machine warms up, do not.
    """
    low, high = halves
    apart = abs(high.value - low.value)
    if not apart > SURE * np.hypot(low.error, high.error):
        return found
    return Turn(found.value, max(found.error, apart / 2))


def _excited(stack: Stack, wanted: np.ndarray) -> tuple[Stack, np.ndarray]:
    """Leave out lines at which the drives are weak beside the noise, compared with others."""
    strength = np.real(np.einsum("lokk->l", stack.total.square))
    there = strength >= STRONG * strength.max()
    return Stack(stack.total.at(there), stack.right[:, there]), wanted[there]


def _is_at_several(share: np.ndarray, lever: np.ndarray) -> bool:
    """Say whether most lines are excited in parts that are apart."""
    part = (np.abs(share) ** 2).sum(axis=(2, 3))
    part = part / np.maximum(part.sum(axis=0), np.finfo(float).tiny)
    mean = lever @ part
    scatter = np.sqrt(np.maximum(lever**2 @ part - mean**2, 0.0))
    return bool(np.median(scatter) >= SPREAD * np.ptp(lever))
