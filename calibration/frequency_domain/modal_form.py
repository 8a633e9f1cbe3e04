"""A system in real modal form, its response, and how that changes with each of its numbers."""

from dataclasses import dataclass, replace

import numpy as np

FAR = 50.0
"""Largest logarithm of a decay."""


@dataclass(frozen=True, eq=False)
class ModalForm:
    """A stable system of resonances and of poles that do not ring: G(s) = C (s I - A)^-1 B + D.

    A is block diagonal: -decay of a real pole; [[-decay, turn], [-turn, -decay]] of a pair.  Pairs come first.

    Parameters
    ----------
    decay : array, shape (modes,), > 0, the unit of s
    turn : array, shape (pairs,), the unit of s
    B : array, shape (n, m), any unit
    C : array, shape (p, n), any unit
    D : array, shape (p, m), any unit
    """

    decay: np.ndarray
    turn: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray

    @property
    def order(self) -> int:
        """Number of states."""
        return len(self.B)

    @property
    def A(self) -> np.ndarray:  # noqa: N802 (its name in every textbook)
        """Return A, shape (n, n)."""
        first, second, single = self._places()
        pairs = len(self.turn)
        matrix = np.zeros((self.order, self.order))
        matrix[first, first] = matrix[second, second] = -self.decay[:pairs]
        matrix[first, second], matrix[second, first] = self.turn, -self.turn
        matrix[single, single] = -self.decay[pairs:]
        return matrix

    @property
    def poles(self) -> np.ndarray:
        """Return a pole a mode, of a pair the upper one, shape (modes,), the unit of s."""
        above = np.zeros(len(self.decay))
        above[: len(self.turn)] = np.abs(self.turn)
        poles: np.ndarray = -self.decay + 1j * above
        return poles

    @property
    def numbers(self) -> np.ndarray:
        """Return all that it is made of in one array: log decay, turn, B, C, D."""
        parts = (np.log(self.decay), self.turn, self.B, self.C, self.D)
        return np.concatenate([part.ravel() for part in parts])

    def with_numbers(self, numbers: np.ndarray) -> "ModalForm":
        """Return one of the same shape with other numbers.

        Parameters
        ----------
        numbers : array, shape (count,), see `numbers`
        """
        shapes = [each.shape for each in (self.decay, self.turn, self.B, self.C, self.D)]
        ends = np.cumsum([int(np.prod(shape)) for shape in shapes])
        parts = [part.reshape(shape) for part, shape in zip(np.split(numbers, ends[:-1]), shapes, strict=True)]
        return replace(
            self, decay=np.exp(np.clip(parts[0], -FAR, FAR)), turn=parts[1], B=parts[2], C=parts[3], D=parts[4]
        )

    def response(self, points: np.ndarray) -> np.ndarray:
        """Return G at values of s: shape (points, p, m).

        Parameters
        ----------
        points : complex array, shape (points,), the unit of s
        """
        found: np.ndarray = self.C @ self._states(points) + self.D
        return found

    def sizes(self, points: np.ndarray, sigma: np.ndarray) -> np.ndarray:
        """Return how much each mode contributes to the response, re its errors: shape (modes,), 1.

        Parameters
        ----------
        points : complex array, shape (points,), the unit of s
        sigma : array, shape (points, p, m), the response's unit
        """
        states = self._states(points)
        first, second, single = self._places()
        parts = [(at, other) for at, other in zip(first, second, strict=True)] + [(at,) for at in single]
        each = (self.C[:, list(part)] @ states[:, list(part)] for part in parts)
        return np.array([np.linalg.norm(part / sigma) for part in each])

    def without(self, mode: int) -> "ModalForm":
        """Return it without one of its modes, counted as in `decay`."""
        pairs = len(self.turn)
        gone = [2 * mode, 2 * mode + 1] if mode < pairs else [pairs + mode]
        turn = np.delete(self.turn, mode) if mode < pairs else self.turn
        return replace(
            self,
            decay=np.delete(self.decay, mode),
            turn=turn,
            B=np.delete(self.B, gone, axis=0),
            C=np.delete(self.C, gone, axis=1),
        )

    def with_single(self, pair: int) -> "ModalForm":
        """Return it with one real pole in place of a pair, as fast as that."""
        rest = self.without(pair)
        return replace(
            rest,
            decay=np.append(rest.decay, np.hypot(self.decay[pair], self.turn[pair])),
            B=np.vstack([rest.B, self.B[2 * pair]]),
            C=np.column_stack([rest.C, self.C[:, 2 * pair]]),
        )

    def slopes(self, points: np.ndarray, is_direct: bool = True) -> tuple[np.ndarray, np.ndarray]:
        """Return G, and its derivative by each of the numbers: shapes (points, p, m) and (points, p, m, count).

        Parameters
        ----------
        points : complex array, shape (points,), the unit of s
        is_direct : bool, optional
            Without it D does not change.
        """
        (p, n), m, pairs = self.C.shape, self.B.shape[1], len(self.turn)
        states, seen = self._states(points), self.outlets(points)
        first, second, single = self._places()
        by = np.zeros((len(points), p, m, len(self.numbers)), complex)
        both = seen[:, :, :, np.newaxis] * states[:, np.newaxis, :, :]  # of a state with itself
        at_pairs = both[:, :, first] + both[:, :, second]
        by[..., :pairs] = -self.decay[:pairs] * np.moveaxis(at_pairs, 2, -1)
        by[..., pairs : len(self.decay)] = -self.decay[pairs:] * np.moveaxis(both[:, :, single], 2, -1)
        turned = np.einsum("kai,kij->kaji", seen[:, :, first], states[:, second])
        turned -= np.einsum("kai,kij->kaji", seen[:, :, second], states[:, first])
        start = len(self.decay)
        by[..., start : start + pairs] = turned
        start += pairs
        for column in range(m):
            by[:, :, column, start + column : start + n * m : m] = seen
        start += n * m
        for row in range(p):
            by[:, row, :, start + row * n : start + (row + 1) * n] = np.moveaxis(states, 1, -1)
        start += p * n
        if is_direct:
            for row in range(p):
                for column in range(m):
                    by[:, row, column, start + row * m + column] = 1.0
        return self.C @ states + self.D, by

    def _places(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return where the first and the second states of pairs, and those of real poles, stand."""
        pairs = np.arange(len(self.turn))
        return 2 * pairs, 2 * pairs + 1, np.arange(2 * len(pairs), self.order)

    def _states(self, points: np.ndarray) -> np.ndarray:
        """Return (s I - A)^-1 B, shape (points, n, m)."""
        first, second, single = self._places()
        away, turn, size = self._away(points)
        found = np.empty((len(points), *self.B.shape), complex)
        found[:, first] = (away * self.B[first] + turn * self.B[second]) / size
        found[:, second] = (away * self.B[second] - turn * self.B[first]) / size
        found[:, single] = self.B[single] / self._single(points)[:, :, np.newaxis]
        return found

    def outlets(self, points: np.ndarray) -> np.ndarray:
        """Return C (s I - A)^-1, shape (points, p, n)."""
        first, second, single = self._places()
        away, turn, size = (np.moveaxis(each, 1, 2) for each in self._away(points))
        found = np.empty((len(points), *self.C.shape), complex)
        found[:, :, first] = (away * self.C[:, first] - turn * self.C[:, second]) / size
        found[:, :, second] = (away * self.C[:, second] + turn * self.C[:, first]) / size
        found[:, :, single] = self.C[:, single] / self._single(points)[:, np.newaxis, :]
        return found

    def _away(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return s + decay, turn and (s + decay)^2 + turn^2 of the pairs, shape (points, pairs, 1) or (1, pairs, 1)."""
        away = points[:, np.newaxis, np.newaxis] + self.decay[: len(self.turn), np.newaxis]
        turn = self.turn[np.newaxis, :, np.newaxis]
        return away, turn, away**2 + turn**2

    def _single(self, points: np.ndarray) -> np.ndarray:
        away: np.ndarray = points[:, np.newaxis] + self.decay[len(self.turn) :]
        return away
