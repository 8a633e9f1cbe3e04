"""From the triangle to states: singular values, observability, A and C, and the map from the past to the state."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.linalg import lstsq, solve_triangular, svd

from calibration.subspace.windows import Layout

Method = Literal["n4sid", "moesp", "pbsid"]
_RANK = 1e-10
"""Directions of the past weaker than this part of the strongest tell nothing."""
_TIED = 5.0
"""Directions of the past are used whose part tied to the future inputs is at most so many times their own part."""


@dataclass(frozen=True)
class Projection:
    """What the past explains of the future outputs, the future inputs' part taken out.

    Parameters
    ----------
    directions : array, shape (future p, count), 1
        Left singular vectors.
    singular_values : array, shape (count,), 1, falling
    """

    directions: np.ndarray
    singular_values: np.ndarray

    def observability(self, order: int) -> np.ndarray:
        """Return the outputs' first samples per state, C, C A, C A^2 ...: shape (future p, order)."""
        gamma: np.ndarray = self.directions[:, :order] * np.sqrt(self.singular_values[:order])
        return gamma


def project(triangle: np.ndarray, layout: Layout, method: Method) -> Projection:
    """Take the singular values of the future outputs' projection on the past.

    Parameters
    ----------
    triangle : array, shape (rows, rows), 1
        As `Windows.triangle` gives it.
    layout : Layout
    method : "n4sid", "moesp" or "pbsid"
        The projection along the future inputs (oblique, unit weights), the one on what of the past is orthogonal to the
        future inputs, or what a predictor of the past's length foretells without any future inputs, which alone is
        right where those follow from outputs.

    Source
    ------
    Van Overschee and De Moor 1994, "N4SID: Subspace algorithms for the identification of combined
    deterministic-stochastic systems", Automatica 30, 75-93; Verhaegen 1994, "Identification of the deterministic part
    of MIMO state space models given in innovations form from input-output data", Automatica 30, 61-74 (PO-MOESP);
    Chiuso and Picci 2005, "Consistency analysis of some closed-loop subspace identification methods", Automatica 41,
    377-391 (the predictor's).
    """
    ahead, past, future = layout.parts
    if method == "moesp":
        explained = triangle[future, past]
    else:
        explained = _past_to_future(triangle, layout, method) @ triangle[past, ahead.start : past.stop]
    directions, values, _ = svd(explained, full_matrices=False, check_finite=False)
    return Projection(directions, values)


def transition(gamma: np.ndarray, outputs: int) -> tuple[np.ndarray, np.ndarray]:
    """Return A and C, shapes (n, n) and (outputs, n): what takes the observability matrix one sample on, and its top.

    The states' own sequence is not used: the shift of one such sequence gives poles that are wrong however long the
    record.

    Parameters
    ----------
    gamma : array, shape (future outputs, n), 1
        As `Projection.observability` gives it.
    outputs : int
    """
    matrix: np.ndarray = lstsq(gamma[:-outputs], gamma[outputs:], check_finite=False)[0]
    return matrix, gamma[:outputs].copy()


def stabilized(matrix: np.ndarray, samples: int) -> np.ndarray:
    """Return A, shape (n, n), with every pole on or outside of the unit circle moved inside.

    Such a pole z becomes 1 / conj(z), or lies 1 / samples inside of the circle if that is further in: a record cannot
    tell longer memories.  Modes' shapes stay.

    Parameters
    ----------
    matrix : array, shape (n, n), 1
    samples : int
        Length of the longest record.
    """
    poles, shapes = np.linalg.eig(matrix)
    radius = np.abs(poles)
    outside = radius >= 1
    if not outside.any():
        return matrix
    target = np.minimum(1 / np.maximum(radius, 1.0), 1 - 1 / samples)
    moved = np.where(outside, poles / np.maximum(radius, np.finfo(float).tiny) * target, poles)
    inside: np.ndarray = np.linalg.solve(shapes.T, (shapes * moved).T).T.real
    return inside


def state_map(triangle: np.ndarray, layout: Layout, gamma: np.ndarray, method: Method) -> np.ndarray:
    """Return what makes the state of a window's past, shape (n, rows of the past).

    Parameters
    ----------
    triangle : array, shape (rows, rows), 1
    layout : Layout
    gamma : array, shape (future p, n), 1
    method : "n4sid", "moesp" or "pbsid"
    """
    mapped: np.ndarray = lstsq(gamma, _past_to_future(triangle, layout, method), check_finite=False)[0]
    return mapped


def _past_to_future(triangle: np.ndarray, layout: Layout, method: Method) -> np.ndarray:
    """Return what the past tells of the future outputs were there no further inputs, shape (future p, past)."""
    return _foretold(triangle, layout) if method == "pbsid" else _regressed(triangle, layout)


def _foretold(triangle: np.ndarray, layout: Layout) -> np.ndarray:
    """Return it from a predictor one step ahead, which is fed what it has foretold itself.

    That predictor is the regression of the first future output on the past alone: no later input is in it.
    """
    _, past, future = layout.parts
    width, outputs = layout.inputs + layout.outputs, layout.outputs
    known, wanted = triangle[past, : past.stop], triangle[future.start : future.start + outputs, : past.stop]
    ahead = lstsq(known.T, wanted.T, cond=_RANK, check_finite=False)[0].T
    lags = ahead.reshape(outputs, layout.past, width)[:, ::-1, layout.inputs :]
    told: list[np.ndarray] = []
    for step in range(layout.future):
        now = np.zeros_like(ahead)
        if step < layout.past:
            now[:, step * width :] = ahead[:, : ahead.shape[1] - step * width]
        for lag in range(1, min(step, layout.past) + 1):
            now += lags[:, lag - 1] @ told[step - lag]
        told.append(now)
    return np.concatenate(told)


def _regressed(triangle: np.ndarray, layout: Layout) -> np.ndarray:
    """Return it from the regression of the future outputs on the past beside the future inputs.

    Directions of the past that the future inputs nearly tell (of a chirp, most) would carry the error of what little is
    their own over to all that is tied: they are left out, which keeps the columns within the observability's range.
    """
    ahead, past, future = layout.parts
    own, tied, shared = triangle[past, past], triangle[past, ahead], triangle[future, past]
    if np.abs(np.diag(own)).min() * _TIED > np.linalg.norm(tied, axis=1).max():
        solved: np.ndarray = solve_triangular(own, shared.T, lower=True, trans="T", check_finite=False).T
        return solved
    left, sizes, right = svd(own, check_finite=False)
    free = sizes * _TIED > np.linalg.norm(left.T @ tied, axis=1)
    kept: np.ndarray = (shared @ right[free].T / sizes[free]) @ left[:, free].T
    return kept
