"""Random cases of force estimation, and (5.6) by a reference solver and by linear programming."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog, lsq_linear

COULOMB = np.array([8.0, 9.0, 6.0, 1.4, 1.2, 0.6])
"""N m, of the size of an IRB 140's joints."""
NOISE = np.array([0.35, 0.55, 0.28, 0.07, 0.06, 0.035])


@dataclass(frozen=True)
class Cases:
    """Torques of known forces; shapes as of `estimate_force`."""

    torque: np.ndarray
    jacobian: np.ndarray
    friction: np.ndarray
    covariance: np.ndarray
    force: np.ndarray


def random_cases(samples: int, reach: float, seed: int = 1) -> Cases:
    """Draw cases whose friction is within `reach` times its range: beyond 1, noise has to explain the rest."""
    rng = np.random.default_rng(seed)
    jacobian = rng.normal(size=(samples, 3, 6)) * np.array([0.6, 0.6, 0.5, 0.2, 0.15, 0.1])
    middle = rng.normal(size=(samples, 6)) * COULOMB
    half = rng.uniform(0.1, 1.0, (samples, 6)) * COULOMB
    force = 40 * rng.normal(size=(samples, 3))
    friction = middle + half * rng.uniform(-reach, reach, (samples, 6))
    torque = friction - np.einsum("nij,ni->nj", jacobian, force)
    mixed = np.eye(6) + 0.3 * rng.normal(size=(6, 6))
    covariance = np.diag(NOISE) @ mixed @ mixed.T @ np.diag(NOISE)
    return Cases(torque, jacobian, np.stack([middle - half, middle + half], axis=1), covariance, force)


def reference(cases: Cases, n: int) -> tuple[float, np.ndarray]:
    """Return the objective of (5.6) in case n and what it leaves of the torque (N m), by scipy's bounded solver."""
    white = np.linalg.inv(np.linalg.cholesky(cases.covariance))
    matrix = np.hstack([-white @ cases.jacobian[n].T, white])
    low = np.concatenate([np.full(3, -np.inf), cases.friction[n, 0]])
    high = np.concatenate([np.full(3, np.inf), cases.friction[n, 1]])
    found = lsq_linear(matrix, white @ cases.torque[n], (low, high), method="bvls", tol=1e-15, max_iter=1_000)
    left = cases.torque[n] + cases.jacobian[n].T @ found.x[:3] - found.x[3:]
    return float(np.sum((white @ left) ** 2)), left


def extremes(cases: Cases, n: int, left: np.ndarray, slack: float) -> np.ndarray:
    """Return the least and largest of each part of the likely forces in case n, shape (2, 3), N, by simplex."""
    matrix = np.vstack([cases.jacobian[n].T, -cases.jacobian[n].T])
    friction = cases.torque[n] - left
    bound = np.concatenate([cases.friction[n, 1] - friction, friction - cases.friction[n, 0]]) + slack
    found = np.empty((2, 3))
    for side, sign in ((0, 1.0), (1, -1.0)):
        for part in range(3):
            done = linprog(sign * np.eye(3)[part], matrix, bound, bounds=[(None, None)] * 3)
            assert done.status == 0, done.message
            found[side, part] = sign * done.fun
    return found
