"""One linear system with its free steps: those that change what it does, and not just the basis of its states."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eig, matrix_balance, svd

from calibration.state_space.gramian import summed

LEAST_HANKEL = 1e-9
"""Hankel singular values below this, relative to the greatest, count as this in balancing."""

WORST_BALANCE = 1e10
"""Condition of a change of basis beyond which states stay as they are."""

SLOW = 0.5
"""Poles of smaller modulus are not watched: no step takes them out of the unit circle at once."""

LARGEST_MODULUS = 1 - 1e-6
"""Of a pole: its response falls by a factor e in a million samples."""

ROUNDING = 1e-9
"""By which a pole at that limit may seem to be beyond it."""


@dataclass(frozen=True, eq=False)
class Element:
    """x[k+1] = a x[k] + b s[k], with c x[k] added to the outputs; s are some of a fit's inputs.

    Parameters
    ----------
    a : array, shape (n, n), 1
    b : array, shape (n, inputs), any unit
    c : array, shape (outputs, n), any unit
    first : int
        Number of its first input.
    gain_at : int or None
        Column of b from which on it holds a Kalman gain K: the element is the predictor of a system a + K c.
    """

    a: np.ndarray
    b: np.ndarray
    c: np.ndarray
    first: int = 0
    gain_at: int | None = None

    def moved(self, steps: "Steps", amounts: np.ndarray) -> "Element":
        """Return it after a step.

        Parameters
        ----------
        steps : Steps
        amounts : array, shape (free,), any unit
        """
        a, b, c = (np.tensordot(amounts, part, 1) for part in (steps.a, steps.b, steps.c))
        return Element(self.a + a, self.b + b, self.c + c, self.first, self.gain_at)

    def system(self) -> np.ndarray:
        """Return the state matrix of the system, shape (n, n), which for a predictor is not its own."""
        return self.a if self.gain_at is None else self.a + self.b[:, self.gain_at :] @ self.c

    @property
    def is_stable(self) -> bool:
        """Whether it and the system that it predicts have no pole of modulus above `LARGEST_MODULUS`."""
        largest = LARGEST_MODULUS + ROUNDING
        return all(np.abs(np.linalg.eigvals(a)).max() <= largest for a in (self.a, self.system()))


@dataclass(frozen=True, eq=False)
class Steps:
    """Directions in which an element may step.

    Parameters
    ----------
    a : array, shape (free, n, n), 1
    b : array, shape (free, n, inputs), any unit
    c : array, shape (free, outputs, n), any unit
    """

    a: np.ndarray
    b: np.ndarray
    c: np.ndarray

    def of_system(self, element: Element) -> np.ndarray:
        """Return how `element.system()` moves with each, shape (free, n, n)."""
        if element.gain_at is None:
            return self.a
        k = slice(element.gain_at, None)
        moved: np.ndarray = self.a + self.b[:, :, k] @ element.c + element.b[:, k] @ self.c
        return moved


def balanced(element: Element) -> tuple[Element, np.ndarray]:
    """Return it with its states balanced, and the basis T, shape (n, n), with x = T (balanced state).

    Where that would be worse than its states are, such as far from a normal matrix, they are scaled alone.

    Source
    ------
    Laub, Heath, Paige, Ward 1987, IEEE Trans. Automatic Control 32(2), through square roots of the Gramians.
    """
    _, spread = matrix_balance(element.a, permute=False)
    even = _turned(element, spread)
    with np.errstate(over="ignore", invalid="ignore"):
        gramians = summed(even.a, even.b @ even.b.T), summed(even.a.T, even.c.T @ even.c)
    if not np.isfinite(gramians).all():  # far from normal: rounding outgrows the poles
        return even, spread
    left, right = map(_root, gramians)
    _, hankel, rows = svd(right.T @ left)
    basis = left @ rows.T / np.sqrt(hankel.clip(LEAST_HANKEL * max(hankel[0], np.finfo(float).tiny)))
    if not np.linalg.cond(basis) <= WORST_BALANCE:
        return even, spread
    return _turned(even, basis), spread @ basis


def _turned(element: Element, basis: np.ndarray) -> Element:
    a, b = np.linalg.solve(basis, element.a @ basis), np.linalg.solve(basis, element.b)
    return Element(a, b, element.c @ basis, element.first, element.gain_at)


def every_step(element: Element) -> Steps:
    """Return an orthonormal set of the steps orthogonal to those that a change of basis makes.

    Source
    ------
    McKelvey, Helmersson, Ribarits 2004, Data driven local coordinates for multivariable linear systems and their
    application to system identification, Automatica 40(9), section 3.
    """
    a, b, c, order = element.a, element.b, element.c, len(element.a)
    turns = np.eye(order**2).reshape(-1, order, order)
    parts = [(turns @ a - a @ turns), turns @ b, -(c @ turns)]
    tangent = np.concatenate([part.reshape(order**2, -1) for part in parts], axis=1).T
    free = np.linalg.qr(tangent, mode="complete")[0][:, order**2 :].T
    cuts = np.split(free, [a.size, a.size + b.size], axis=1)
    return Steps(*(cut.reshape(-1, *part.shape) for cut, part in zip(cuts, (a, b, c), strict=True)))


def gain_steps(element: Element) -> Steps:
    """Return the steps of a Kalman gain alone, of a predictor driven by the outputs alone: a = A - K c, b = K."""
    turns = np.eye(element.b.size).reshape(-1, *element.b.shape)
    return Steps(-(turns @ element.c), turns, np.zeros((len(turns), *element.c.shape)))


def margins(element: Element, steps: Steps) -> tuple[np.ndarray, np.ndarray]:
    """Return how far poles are from the largest modulus, shape (poles,), and their approach, shape (poles, free).

    Poles of the element and of the system that it predicts; of a complex pair one.
    """
    distances, approaches = [np.zeros(0)], [np.zeros((0, len(steps.a)))]
    moving = [(element.a, steps.a)]
    if element.gain_at is not None:
        moving.append((element.system(), steps.of_system(element)))
    for matrix, directions in moving:
        poles, slopes = pole_slopes(matrix, directions)
        watched = (np.abs(poles) > SLOW) & (poles.imag >= 0)
        poles, slopes = poles[watched], slopes[watched]
        distances.append(LARGEST_MODULUS - np.abs(poles))
        approaches.append((slopes * (poles.conj() / np.abs(poles))[:, None]).real)
    return np.concatenate(distances), np.concatenate(approaches)


def pole_slopes(matrix: np.ndarray, directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the poles of a state matrix, complex, shape (n,), and their derivatives, complex, shape (n, free).

    Parameters
    ----------
    matrix : array, shape (n, n), 1
    directions : array, shape (free, n, n), 1
    """
    poles, left, right = eig(matrix, left=True)
    overlap = np.sum(left.conj() * right, axis=0)
    overlap = np.where(np.abs(overlap) > np.finfo(float).tiny, overlap, np.finfo(float).tiny)
    slopes: np.ndarray = np.einsum("in,kin->nk", left.conj(), directions @ right) / overlap[:, None]
    return poles, slopes


def _root(gramian: np.ndarray) -> np.ndarray:
    values, vectors = np.linalg.eigh((gramian + gramian.T) / 2)
    root: np.ndarray = vectors * np.sqrt(values.clip(0))
    return root
