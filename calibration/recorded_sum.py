"""What all blocks of all records say together: their normal equations, weighed by each one's noise, and solved."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from typing import Self

import numpy as np

from calibration.collinearity import together
from calibration.recorded_response import CHUNK, FREE, RANK, Evidence, around

BETWEEN = 8
"""Lines to each side over which the scatter between blocks is averaged."""


@dataclass(frozen=True)
class Lines:
    """What records say of the lines wanted.

    Parameters
    ----------
    response : complex array, shape (lines, outputs, inputs), m/s^2 per V
        0 where there is nothing to tell it from.
    variance : array, the same shape, (m/s^2 per V)^2
        E |G_hat - G|^2, from what the polynomials leave and from how far the blocks are apart; infinite there.
    coherence : array, shape (lines, outputs), 0 to 1
        Part of the response's power in the window, without transients, that G explains.
    together : array, shape (lines,), 0 to 1
        The weakest combination of the drives over the strongest, each in units of its own power: 0 where they go
        together.
    """

    response: np.ndarray
    variance: np.ndarray
    coherence: np.ndarray
    together: np.ndarray


@dataclass(frozen=True)
class Sum:
    """Normal equations of all blocks, each divided by its noise.

    Parameters
    ----------
    square : complex array, shape (lines, outputs, k, k)
    right : complex array, shape (lines, outputs, k)
    power, own_left : arrays, shape (lines, outputs)
        Of the responses; and what each block's own fit leaves of it.
    told, told_left : arrays, shape (lines, outputs)
        How strong the drives are beside the noise, summed over blocks that leave rows enough; and the same times what
        a block's own fit leaves of a row.
    rows, rank : arrays, shape (lines,), 1
        Free equations, and coefficients that the blocks tell by themselves, summed over them.
    """

    square: np.ndarray
    right: np.ndarray
    power: np.ndarray
    own_left: np.ndarray
    told: np.ndarray
    told_left: np.ndarray
    rows: np.ndarray
    rank: np.ndarray

    @classmethod
    def empty(cls, lines: int, outputs: int, coefficients: int) -> Self:
        """Return those of no block."""
        square = np.zeros((lines, outputs, coefficients, coefficients), complex)
        right = np.zeros((lines, outputs, coefficients), complex)
        return cls(square, right, *np.zeros((4, lines, outputs)), *np.zeros((2, lines)))

    @classmethod
    def of(cls, block: Evidence, noise: np.ndarray) -> Self:
        """Return those of one block alone; see `take`."""
        lines, coefficients, outputs = block.right.shape
        alone = cls.empty(lines, outputs, coefficients)
        alone.take(block, noise)
        return alone

    def take(self, block: Evidence, noise: np.ndarray) -> None:
        """Add a block, divided by its noise, (lines, outputs), (m/s^2 s)^2."""
        weight = 1 / noise
        for first in range(0, len(weight), CHUNK):
            lines = slice(first, first + CHUNK)
            self.square[lines] += weight[lines, :, None, None] * block.square[lines, None]
        self.right[:] += weight[:, :, None] * block.right.swapaxes(1, 2)
        self.power[:] += weight * block.power
        self.own_left[:] += weight * block.left
        free = (block.rows - block.rank)[:, None]
        told = np.where(free >= FREE, weight * np.real(np.einsum("lkk->l", block.square))[:, None], 0.0)
        self.told[:] += told
        self.told_left[:] += told * weight * block.left / np.maximum(free, 1.0)
        self.rows[:] += block.rows
        self.rank[:] += block.rank

    def added(self, other: Self, turn: np.ndarray | float = 1.0) -> Self:
        """Add another's equations, to one's own arrays; `turn` (lines,) turns its responses' phases."""
        self.right[:] += other.right * np.reshape(turn, (-1, 1, 1))
        for each in fields(self):
            if each.name != "right":
                getattr(self, each.name)[:] += getattr(other, each.name)
        return self

    def copy(self) -> Self:
        """Return a copy that others can be added to."""
        return self.at(slice(None))

    def at(self, lines: slice | np.ndarray) -> Self:
        """Return a copy of the equations of some lines."""
        return type(self)(**{each.name: getattr(self, each.name)[lines].copy() for each in fields(self)})

    def certainty(self, inputs: int) -> np.ndarray:
        """Return how much they tell of G at each line, (lines,): the sum over elements of 1 / variance."""
        told = []
        for part in self._parts():
            scaled, size = part.scaled()
            inverse = np.linalg.inv(scaled + 1e-9 * np.eye(scaled.shape[-1]))
            gain = np.real(np.einsum("loii->loi", inverse)) / size**2
            told.append((1 / gain[:, :, :inputs]).sum(axis=(1, 2)))
        return np.concatenate(told)

    def improve(self, other: Self, inputs: int) -> None:
        """Put another's equations in the place of one's own at each line where they tell more of G."""
        better = other.certainty(inputs) > self.certainty(inputs)
        for each in fields(self):
            getattr(self, each.name)[better] = getattr(other, each.name)[better]

    def solved(self, inputs: int) -> Lines:
        """Solve them.

        Parameters
        ----------
        inputs : int
        """
        of_parts = (part.solution(inputs) for part in self._parts())
        response, gain, left, fitted, together = (np.concatenate(each) for each in zip(*of_parts, strict=True))
        free = self.rows[:, None] - fitted
        with np.errstate(invalid="ignore"):  # 0 of nothing
            variance = self._per_row(left, free, fitted)[:, :, None] * gain
        variance = np.where(np.isfinite(gain), variance, np.inf)
        unexplained = (left / np.maximum(free, 1)) / np.maximum(self.power / self.rows[:, None], np.finfo(float).tiny)
        response = np.where(np.isfinite(variance), response, 0.0)
        return Lines(response, variance, np.clip(1 - unexplained, 0.0, 1.0), together)

    def solution(self, inputs: int) -> tuple[np.ndarray, ...]:
        """Solve them without their scatter.

        Returns
        -------
        G, its variance for noise of 1 (infinite where nothing is told), the power left, how many coefficients are told,
        and the weakest combination of drives over the strongest.
        """
        scaled, size = self.scaled()
        values, vectors = np.linalg.eigh(scaled)
        lost = values <= RANK * np.maximum(values[..., -1:], np.finfo(float).tiny)
        inverse_values = np.where(lost, 0.0, 1 / np.where(lost, 1.0, values))
        share = np.einsum("loij,loi->loj", vectors.conj(), self.right / size)
        solution = np.einsum("loij,loj->loi", vectors, inverse_values * share) / size
        explained = (inverse_values * np.abs(share) ** 2).sum(axis=-1)
        part = np.abs(vectors[:, :, :inputs]) ** 2
        is_told = np.einsum("loij,loj->loi", part, lost) < 1e-6
        gain = np.einsum("loij,loj->loi", part, inverse_values) / size[:, :, :inputs] ** 2
        gain = np.where(is_told & (gain > 0), gain, np.inf)
        left = np.maximum(self.power - explained, 0.0)
        own = self.square[:, :, :inputs, :inputs].mean(axis=1)
        return solution[:, :, :inputs], gain, left, (~lost).sum(axis=-1), together(own)

    def scaled(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the square in units of each coefficient's own size, and those sizes, (lines, outputs, k)."""
        size = np.sqrt(np.maximum(np.real(np.einsum("lokk->lok", self.square)), 0.0))
        safe = np.where(size > 0, size, 1.0)
        return self.square / (safe[..., :, None] * safe[..., None, :]), safe

    def _per_row(self, left: np.ndarray, free: np.ndarray, fitted: np.ndarray) -> np.ndarray:
        """Return the power of a row that stands for noise: what is left, or more where blocks are farther apart."""
        own = self.told_left / np.where(self.told > 0, self.told, 1.0)
        pooled = np.where(self.told > 0, own, np.where(free >= 1, left / np.maximum(free, 1), np.inf))
        apart = self.rank[:, None] - fitted
        between = np.maximum(left - self.own_left, 0.0)
        spread = around(between, np.mean, BETWEEN) / np.maximum(around(apart, np.mean, BETWEEN), 1.0)
        return np.where(apart >= 1, np.maximum(pooled, spread), pooled)

    def _parts(self) -> Iterator[Self]:
        """Go through some lines at a time."""
        for first in range(0, len(self.power), CHUNK):
            lines = slice(first, first + CHUNK)
            yield type(self)(**{each.name: getattr(self, each.name)[lines] for each in fields(self)})


def narrow_or_wide(of_reaches: Sequence[Lines]) -> Lines:
    """Take at each line the polynomial that is most certain there.

    Where a wider one misses what a narrower one shows, beyond the latter's variance, that is in its own.

    Parameters
    ----------
    of_reaches : sequence of Lines
        From narrow to wide.

    Source
    ------
    Schoukens, Vandersteen, Barbe and Pintelon 2009, "Nonparametric preprocessing in system identification: a powerful
    tool", European Journal of Control 15(3-4): the local polynomial method; Pintelon and Schoukens 2012, System
    Identification, sec. 7.2.2, for many inputs.
    """
    best = of_reaches[0]
    best = replace(best, variance=around(best.variance, np.median))
    for wide in of_reaches[1:]:
        both = np.isfinite(best.variance) & np.isfinite(wide.variance)
        apart = np.where(both, np.abs(wide.response - best.response) ** 2, 0.0)
        expected = around(np.where(both, best.variance, 0.0), np.mean)
        bent = np.maximum(around(apart, np.mean) - expected, 0.0)
        variance = around(wide.variance, np.median) + bent
        taken = variance <= best.variance
        best = Lines(
            np.where(taken, wide.response, best.response),
            np.where(taken, variance, best.variance),
            np.where(taken.all(axis=2), wide.coherence, best.coherence),
            np.maximum(best.together, wide.together),
        )
    response = np.where(np.isfinite(best.variance), best.response, 0.0)
    return replace(best, response=response)
