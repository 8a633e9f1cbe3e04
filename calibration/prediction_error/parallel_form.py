"""A linear system as sections of first and second order in parallel, the form in which its derivatives are cheap.

A section of second order has the poles of [[sigma, h], [-bend, sigma]]: sigma +- sqrt(-bend h), so that a pair may turn
from real to complex and back on a smooth path.  `h` is no parameter of the section but its scale.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import eig

WORST_CONDITION = 1e8
"""Of the eigenvectors; beyond it (poles that coincide) the matrix is moved a little, as below."""

NUDGE = 1e-8
"""Relative to the norm of the state matrix."""

LEAST_COUPLING = 1e-3
"""Least `h`: real poles nearer to each other than twice this share a section with this coupling."""


@dataclass(frozen=True)
class Sections:
    """Which sections there are: the structure of a parallel form, without its numbers.

    Parameters
    ----------
    sizes : tuple of int, 1 or 2
    firsts, lasts : tuples of int
        Each section is driven by the inputs first <= i < last.
    outputs : int
    direct : int
        How many of the inputs, from the first, reach the outputs within the sample.
    """

    sizes: tuple[int, ...]
    firsts: tuple[int, ...]
    lasts: tuple[int, ...]
    outputs: int
    direct: int

    @cached_property
    def table(self) -> np.ndarray:
        """Size, first state, first and last input, first parameter: integers, shape (sections, 5)."""
        rows, state, parameter = [], 0, 0
        for size, first, last in zip(self.sizes, self.firsts, self.lasts, strict=True):
            rows.append((size, state, first, last, parameter))
            state += size
            parameter += size * (1 + last - first + self.outputs)
        return np.array(rows, dtype=np.int64).reshape(-1, 5)

    @property
    def order(self) -> int:
        """States."""
        return sum(self.sizes)

    @cached_property
    def direct_at(self) -> int:
        """First parameter of the direct path."""
        widths = (last - first for first, last in zip(self.firsts, self.lasts, strict=True))
        return sum(size * (1 + width + self.outputs) for size, width in zip(self.sizes, widths, strict=True))

    @property
    def parameters(self) -> int:
        """How many numbers a form has, more than are free."""
        return self.direct_at + self.outputs * self.direct


@dataclass(frozen=True, eq=False)
class ParallelForm:
    """A parallel form with its numbers.

    Parameters
    ----------
    sections : Sections
    coupling : array, shape (sections,), 1
        The h of each; of no meaning for one of first order.
    values : array, shape (parameters,), any unit
        Section by section: sigma (and bend), the rows of the input matrix input by input, the columns of the output
        matrix output by output; then the direct path output by output.
    """

    sections: Sections
    coupling: np.ndarray
    values: np.ndarray

    @property
    def direct(self) -> np.ndarray:
        """The direct path, shape (outputs, direct)."""
        return self.values[self.sections.direct_at :].reshape(self.sections.outputs, self.sections.direct)


def joined(forms: Sequence[ParallelForm], direct: np.ndarray) -> ParallelForm:
    """Put forms of the same outputs, without direct paths of their own, beside each other.

    Parameters
    ----------
    forms : sequence of ParallelForm
    direct : array, shape (outputs, direct), any unit
        From the first inputs; with none there is no direct path.
    """
    parts = [form.sections for form in forms]
    sections = Sections(
        tuple(size for part in parts for size in part.sizes),
        tuple(first for part in parts for first in part.firsts),
        tuple(last for part in parts for last in part.lasts),
        *direct.shape,
    )
    coupling = np.concatenate([np.zeros(0), *(form.coupling for form in forms)])
    return ParallelForm(sections, coupling, np.concatenate([*(form.values for form in forms), direct.ravel()]))


def decomposed(a: np.ndarray, b: np.ndarray, c: np.ndarray, first: int = 0) -> tuple[ParallelForm, np.ndarray]:
    """Take a system apart into sections; return the form and the basis T, shape (n, n), with x = T (sections' states).

    Parameters
    ----------
    a : array, shape (n, n), 1
    b : array, shape (n, inputs), any unit
    c : array, shape (outputs, n), any unit
    first : int
        Number of its first input.
    """
    basis, blocks = _section_basis(a)
    b, c = np.linalg.solve(basis, b), c @ basis
    values, at = [np.zeros(0)], 0
    for block in blocks:
        here = slice(at, at := at + len(block))
        values += [block[:, 0] * [1, -1][: len(block)], b[here].T.ravel(), c[:, here].ravel()]
    count = len(blocks)
    sizes = tuple(len(block) for block in blocks)
    sections = Sections(sizes, (first,) * count, (first + b.shape[1],) * count, len(c), 0)
    return ParallelForm(sections, np.array([block[0, -1] for block in blocks]), np.concatenate(values)), basis


def _section_basis(a: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
    """Return real vectors, shape (n, n), that span the sections' states, and the sections' state matrices."""
    poles, vectors = eig(a)
    if not np.linalg.cond(vectors) <= WORST_CONDITION:
        nudge = np.random.default_rng(0).standard_normal(a.shape)
        poles, vectors = eig(a + NUDGE * max(float(np.linalg.norm(a)), 1.0) * nudge / np.linalg.norm(nudge))
    spans, blocks = [], []
    for k in np.flatnonzero(poles.imag > 0):
        spans.append(np.array([vectors[:, k].real, vectors[:, k].imag]).T)
        blocks.append(np.array([[poles[k].real, poles[k].imag], [-poles[k].imag, poles[k].real]]))
    for group in _neighbours(poles, np.flatnonzero(poles.imag == 0)):
        block, span = _real_section(poles[group].real, vectors[:, group].real)
        spans.append(span)
        blocks.append(block)
    return np.concatenate(spans, axis=1), blocks


def _neighbours(poles: np.ndarray, real: np.ndarray) -> list[list[int]]:
    """Pair real poles with the next; of an odd number the one whose absence leaves the closest pairs stays alone."""
    real = real[np.argsort(poles[real].real)]
    if len(real) % 2 == 0:
        return [list(pair) for pair in real.reshape(-1, 2)]
    rests = [np.delete(real, k) for k in range(0, len(real), 2)]
    best = int(np.argmin([np.sum(np.diff(poles[rest].real.reshape(-1, 2))) for rest in rests]))
    return [*(list(pair) for pair in rests[best].reshape(-1, 2)), [int(real[2 * best])]]


def _real_section(poles: np.ndarray, vectors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return state matrix and states' span of one real pole, or of two, lower first."""
    if len(poles) == 1:
        return poles.reshape(1, 1), vectors
    sigma, half = poles.mean(), (poles[1] - poles[0]) / 2
    low = vectors[:, 0]
    high = vectors[:, 1] if low @ vectors[:, 1] >= 0 else -vectors[:, 1]
    coupling = max(float(half), LEAST_COUPLING)
    span = np.array([(high + low) / 2, (high - low) / 2 * coupling / max(half, np.finfo(float).tiny)]).T
    return np.array([[sigma, coupling], [half**2 / coupling, sigma]]), span
