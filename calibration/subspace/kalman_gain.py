"""The Kalman gain from the covariances of what a state-space model leaves of the compressed data."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, solve_discrete_are

from calibration.subspace.windows import Layout

_HALVINGS = 60
_ROUNDING = 1e-12


@dataclass(frozen=True)
class Gain:
    """A Kalman gain with its innovations' covariance.

    Parameters
    ----------
    matrix : array, shape (n, p), 1 per the outputs' units
    innovation : array, shape (p, p), products of the outputs' units
    by_riccati : bool
        False where the Riccati equation had no stabilizing solution.
    """

    matrix: np.ndarray
    innovation: np.ndarray
    by_riccati: bool


def kalman_gain(
    triangle: np.ndarray,
    layout: Layout,
    mapped: np.ndarray,
    system: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray],
) -> Gain:
    """Solve the Riccati equation with the covariances of the identified process and measurement noise.

    Where it has no stabilizing solution, the gain is the regression of the state's noise on the output's, halved until
    the predictor A - K C is stable (A is).

    Parameters
    ----------
    triangle : array, shape (rows, rows), 1
    layout : Layout
    mapped : array, shape (n, rows of the past), 1
        Of `state_map`.
    system : A, B, C and D, arrays of shapes (n, n), (n, m), (p, n) and (p, m), 1

    Source
    ------
    Van Overschee and De Moor 1996, Subspace Identification for Linear Systems, section 4.2 (noise covariances from
    the residuals of the state equations), with A and C from the shift of the observability matrix.
    """
    transition, _, outlet, _ = system
    process, mixed, measurement = _covariances(triangle, layout, mapped, system)
    if (found := riccati_gain(transition, outlet, process, mixed, measurement)) is not None:
        return found
    gain = mixed @ np.linalg.pinv(measurement, hermitian=True)
    return Gain(halved_until_stable(transition, outlet, gain), measurement, by_riccati=False)


def riccati_gain(
    transition: np.ndarray, outlet: np.ndarray, process: np.ndarray, mixed: np.ndarray, measurement: np.ndarray
) -> Gain | None:
    """Solve the Riccati equation; none where it has no stabilizing solution.

    Parameters
    ----------
    transition : array, shape (n, n), 1
        A, stable or not.
    outlet : array, shape (p, n), any unit
        C.
    process : array, shape (n, n), 1
    mixed : array, shape (n, p), the outputs' units
    measurement : array, shape (p, p), products of the outputs' units
    """
    try:
        error = solve_discrete_are(transition.T, outlet.T, process, measurement, s=mixed)
        innovation = outlet @ error @ outlet.T + measurement
        gain = np.linalg.solve(innovation, (transition @ error @ outlet.T + mixed).T).T
    except (LinAlgError, ValueError):
        return None
    if not (is_stable(transition - gain @ outlet) and np.all(np.linalg.eigvalsh(innovation) > 0)):
        return None
    return Gain(gain, (innovation + innovation.T) / 2, by_riccati=True)


def residual_covariances(
    triangle: np.ndarray, layout: Layout, mapped: np.ndarray, transition: np.ndarray, outlet: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the noise's covariances with B and D fitted to the windows themselves, as of `_covariances`.

    Parameters
    ----------
    triangle : array, shape (rows, rows), 1
    layout : Layout
    mapped : array, shape (n, rows of the past), 1
    transition : array, shape (n, n), 1
    outlet : array, shape (p, n), 1
    """
    order, drive = len(transition), layout.rows(layout.past, layout.past + 1, slice(0, layout.inputs))
    left = _left_with_inputs(layout, mapped, transition, outlet) @ triangle
    through = np.linalg.lstsq(triangle[drive].T, left.T, rcond=None)[0].T
    return _split(left - through @ triangle[drive], order)


def innovation_gain(
    triangle: np.ndarray, layout: Layout, mapped: np.ndarray, system: tuple[np.ndarray, np.ndarray]
) -> Gain | None:
    """Regress the next state on what the state's prediction of the outputs leaves; none where that is not stable.

    Right where inputs follow from outputs, since inputs and innovations stand beside one another in the regression.

    Parameters
    ----------
    triangle : array, shape (rows, rows), 1
    layout : Layout
    mapped : array, shape (n, rows of the past), 1
    system : A and C, arrays of shapes (n, n) and (p, n), 1

    Source
    ------
    Chiuso and Picci 2005, "Consistency analysis of some closed-loop subspace identification methods", Automatica 41.
    """
    transition, outlet = system
    order = len(transition)
    left = _left_with_inputs(layout, mapped, transition, outlet) @ triangle
    drive = triangle[layout.rows(layout.past, layout.past + 1, slice(0, layout.inputs))]
    beside = np.concatenate([left[order:], drive])
    gain = np.linalg.lstsq(beside.T, left[:order].T, rcond=None)[0].T[:, : layout.outputs]
    if not is_stable(transition - gain @ outlet):
        return None
    return Gain(gain, left[order:] @ left[order:].T, by_riccati=False)


def halved_until_stable(transition: np.ndarray, outlet: np.ndarray, gain: np.ndarray) -> np.ndarray:
    """Return a gain, shape (n, p), or the first half of a half of it with which the predictor is stable.

    Parameters
    ----------
    transition : array, shape (n, n), 1
        A, stable.
    outlet : array, shape (p, n), any unit
        C.
    gain : array, shape (n, p), 1 per the outputs' units
    """
    for _ in range(_HALVINGS):
        if is_stable(transition - gain @ outlet):
            return gain
        gain = gain / 2
    return np.zeros_like(gain)


def whitening(innovation: np.ndarray) -> np.ndarray:
    """Return a triangular root, shape (p, p), of a covariance, of outputs that repeat one another too.

    Parameters
    ----------
    innovation : array, shape (p, p), products of the outputs' units
    """
    least = _ROUNDING * float(np.trace(innovation)) + np.finfo(float).tiny
    root: np.ndarray = np.linalg.cholesky(innovation + least * np.eye(len(innovation)))
    return root


def is_stable(matrix: np.ndarray, radius: float = 1.0) -> bool:
    """Whether every eigenvalue of a matrix, shape (n, n), lies inside of the unit circle, or of a smaller one.

    Parameters
    ----------
    matrix : array, shape (n, n), 1
    radius : float, 1
    """
    return bool(np.isfinite(matrix).all() and np.all(np.abs(np.linalg.eigvals(matrix)) < radius))


def _covariances(
    triangle: np.ndarray,
    layout: Layout,
    mapped: np.ndarray,
    system: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray],
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return those of w, of w with v, and of v: what x[k+1] = A x + B u + w, y = C x + D u + v leave, past to past."""
    return _split(_left(layout, mapped, system) @ triangle, len(system[0]))


def _left_with_inputs(layout: Layout, mapped: np.ndarray, transition: np.ndarray, outlet: np.ndarray) -> np.ndarray:
    """Return what makes w above v, what inputs do still in them, of the rows of a window, shape (n + p, rows)."""
    inlet, direct = np.zeros((len(transition), layout.inputs)), np.zeros((layout.outputs, layout.inputs))
    return _left(layout, mapped, (transition, inlet, outlet, direct))


def _left(
    layout: Layout, mapped: np.ndarray, system: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
) -> np.ndarray:
    """Return what makes w above v of the rows of a window, shape (n + p, rows)."""
    transition, inlet, outlet, direct = system
    order, now = len(transition), layout.past
    before, after = layout.rows(0, now), layout.rows(1, now + 1)
    drive = layout.rows(now, now + 1, slice(0, layout.inputs))
    response = layout.rows(now, now + 1, slice(layout.inputs, None))
    left = np.zeros((order + layout.outputs, len(layout.order)))
    left[:order, after] += mapped
    left[:order, before] -= transition @ mapped
    left[:order, drive] -= inlet
    left[order:, response] += np.eye(layout.outputs)
    left[order:, before] -= outlet @ mapped
    left[order:, drive] -= direct
    return left


def _split(noise: np.ndarray, order: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    covariance = noise @ noise.T
    return covariance[:order, :order], covariance[:order, order:], covariance[order:, order:]
