"""A transition matrix taken apart into its modes."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eig


@dataclass(frozen=True)
class Modal:
    """A = T J T^-1 with a block of one row a real pole, two a conjugate pair.

    Parameters
    ----------
    poles : complex array, shape (modes,), 1
        One of each pair.
    basis : array, shape (n, n), 1
        T: a column of a real pole, the real and the imaginary column of a pair.
    first : array of int, shape (modes,)
        Column of each mode in the basis, the first of two.
    """

    poles: np.ndarray
    basis: np.ndarray
    first: np.ndarray

    @property
    def is_complex(self) -> np.ndarray:
        """Whether each mode is a pair: shape (modes,)."""
        pair: np.ndarray = self.poles.imag != 0
        return pair

    @property
    def condition(self) -> float:
        """Of the basis; large where poles nearly coincide."""
        return float(np.linalg.cond(self.basis)) if len(self.basis) else 1.0


def modal(transition: np.ndarray) -> Modal:
    """Take a transition matrix apart.

    Parameters
    ----------
    transition : array, shape (n, n), 1
    """
    values, vectors = eig(transition)
    keep = np.flatnonzero(values.imag >= 0)
    columns: list[np.ndarray] = []
    first: list[int] = []
    for place in keep:
        first.append(len(columns))
        columns.append(vectors[:, place].real)
        if values[place].imag > 0:
            columns.append(vectors[:, place].imag)
    order = len(transition)
    basis = np.stack(columns, axis=1) if columns else np.zeros((order, 0))
    return Modal(values[keep], basis, np.array(first, dtype=int))
