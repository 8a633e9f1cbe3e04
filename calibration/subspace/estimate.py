"""One model of a given order from compressed windows and the records they came from, in the records' scaled units."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calibration.state_space.model import InnovationModel
from calibration.subspace.kalman_gain import Gain, kalman_gain
from calibration.subspace.realization import Method, Projection, project, stabilized, state_map, transition
from calibration.subspace.regression import Terms
from calibration.subspace.response import fit_response
from calibration.subspace.windows import Layout, Windows


@dataclass(frozen=True)
class Compressed:
    """Windows of records, compressed.

    Parameters
    ----------
    triangle : array, shape (rows, rows), 1
    layout : Layout
    windows : int
        How many the triangle was made of.
    projection : Projection
        Of the triangle.
    method : "n4sid", "moesp" or "pbsid"
    """

    triangle: np.ndarray
    layout: Layout
    windows: int
    projection: Projection
    method: Method


def compress(windows: Windows, method: Method, without: Sequence[int] = (), layout: Layout | None = None) -> Compressed:
    """Compress windows, without some segments or with all, in shorter horizons or their own; take singular values."""
    triangle, inside = windows.triangle(without, layout), windows.layout if layout is None else layout
    return Compressed(triangle, inside, windows.count(without), project(triangle, inside, method), method)


@dataclass(frozen=True)
class Estimate:
    """A, B, C, D and a Kalman gain.

    Parameters
    ----------
    transition, inlet, outlet, direct : arrays, shapes (n, n), (n, m), (p, n), (p, m), 1
    constant : array, shape (p,), 1
        Offset of the outputs.
    gain : Gain
        By the Riccati equation.
    states : tuple of arrays, each of shape (n,), 1
        At the start of each record.
    moved : int
        Poles that had to be moved into the unit circle.
    left : float
        Sum of squares that the free run leaves of all records.
    """

    transition: np.ndarray
    inlet: np.ndarray
    outlet: np.ndarray
    direct: np.ndarray
    constant: np.ndarray
    gain: Gain
    states: tuple[np.ndarray, ...]
    moved: int
    left: float

    def model(self, gain: Gain | None = None) -> InnovationModel:
        """Return it as a model at one sample a second, with its own gain or another."""
        noise = self.gain if gain is None else gain
        return InnovationModel(
            self.transition, self.inlet, self.outlet, self.direct, noise.matrix, 1.0, noise.innovation
        )


def estimate(
    compressed: Compressed,
    order: int,
    drives: Sequence[np.ndarray],
    responses: Sequence[np.ndarray],
    terms: Terms,
) -> Estimate:
    """Estimate a model of a given order.

    Parameters
    ----------
    compressed : Compressed
    order : int
    drives : sequence of arrays, each of shape (N, m), 1
    responses : sequence of arrays, each of shape (N, p), 1
    terms : Terms
        Whether D and an offset of the outputs are fitted; they are 0 otherwise.
    """
    layout = compressed.layout
    gamma = compressed.projection.observability(order)
    raw, outlet = transition(gamma, layout.outputs)
    matrix = stabilized(raw, max(len(drive) for drive in drives))
    fitted = fit_response(matrix, outlet, drives, responses, terms)
    mapped = state_map(compressed.triangle, layout, gamma, compressed.method)
    gain = kalman_gain(compressed.triangle, layout, mapped, (matrix, fitted.inlet, outlet, fitted.direct))
    moved = int(np.sum(np.abs(np.linalg.eigvals(raw)) >= 1))
    return Estimate(
        matrix, fitted.inlet, outlet, fitted.direct, fitted.constant, gain, fitted.states, moved, fitted.left
    )
