"""Whether a learning law makes errors smaller from trial to trial, as the models and what is uncertain in them say."""

from dataclasses import dataclass, replace

import numpy as np

from stagectl.robot.milling.axis_model import diagonal
from stagectl.robot.milling.learning import AXES, PathLaw

LINES = 400
"""Frequencies looked at."""
LEAST = 0.01
"""Of Q and the gain, from which on a frequency counts as learned."""
PARTS = np.concatenate([[0.0], np.geomspace(0.02, 1.0, 30)])
"""Of Q, that are tried at each frequency."""
SHARES = (1.0, 0.75, 0.5, 0.25, 0.0)
"""Of G_K G_M, that are tried."""


@dataclass(frozen=True, eq=False)
class Doubt:
    """What else the robot and the process may be than their models.

    Parameters
    ----------
    frequency : array, shape (bins,), Hz, rising
    robot : complex array, shape (bins, 3), 1
        G_R of each direction as it was measured, without a model.
    spread : array, shape (bins, 3), 1
        How far off that may be.
    coupling : complex array, shape (bins, 3, 3), 1
        What G_K G_M may be instead, in material.
    """

    frequency: np.ndarray
    robot: np.ndarray
    spread: np.ndarray
    coupling: np.ndarray | None = None

    def robot_at(self, frequency: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return response and spread, both of shape (bins, 3), at frequencies, shape (bins,), Hz; at rest it is 1."""
        robot = np.concatenate([np.ones((1, AXES)), self.robot])
        spread = np.concatenate([np.zeros((1, AXES)), self.spread])
        known = np.concatenate([[0.0], self.frequency])
        return interpolated(frequency, known, robot), interpolated(frequency, known, spread).real

    def coupling_at(self, frequency: np.ndarray) -> np.ndarray:
        """Return the other G_K G_M, complex, shape (bins, 3, 3), at frequencies, shape (bins,), Hz; at rest it is 0."""
        assert self.coupling is not None
        known = np.concatenate([[0.0], self.frequency])
        return interpolated(frequency, known, np.concatenate([0.0 * self.coupling[:1], self.coupling]))


@dataclass(frozen=True, eq=False)
class Contraction:
    """By what the error's size is multiplied from trial to trial, at most.

    Parameters
    ----------
    frequency : array, shape (bins,), Hz
    factor : array, shape (bins,), 1
        Largest singular value of I - P Q L (I - G_K G_M), P as the models have it.
    bound : array, shape (bins,), 1
        The same for the worst P that the doubt allows.
    """

    frequency: np.ndarray
    factor: np.ndarray
    bound: np.ndarray

    @property
    def worst(self) -> float:
        """Largest bound."""
        return float(self.bound.max())

    @property
    def is_monotone(self) -> bool:
        """Whether the error shrinks at every frequency that is learned, whatever the doubt allows."""
        return bool((self.bound < 1.0).all())

    def refuse_divergence(self) -> None:
        """Refuse a law under which an error may grow by ValueError with frequency and factor."""
        if not self.is_monotone:
            at = int(np.argmax(self.bound))
            raise ValueError(
                f"at {self.frequency[at]:.3g} Hz an error may become {self.bound[at]:.3g} times itself from trial to "
                f"trial ({self.factor[at]:.3g} by the models alone), must be < 1: lower learning.gain or "
                "learning.cutoff, or calibrate again"
            )


def contraction(law: PathLaw, doubt: Doubt | None = None) -> Contraction:
    """Hold a law against the models, and against all that they might be instead.

    Looked at are frequencies at which at least a hundredth of an error is learned; where it is less, errors stay as
    they are.

    Parameters
    ----------
    law : PathLaw
    doubt : Doubt, optional
        None for models that are exact.

    Returns
    -------
    Contraction

    Source
    ------
    Norrlöf 2000, Iterative Learning Control: Analysis, Design, and Experiments, ch. 5: in the frequency domain
    e_{k+1} = (I - P Q L') e_k, which shrinks monotonously in the 2-norm where its largest singular value is below 1.

    Departs
    -------
    P is that of the measured response as well as that of the models, with the response's spread by the triangle
    inequality; and G_K G_M is that of the models, none at all, or the other one.
    """
    frequency = np.linspace(0.0, law.highest, LINES)
    frequency = frequency[law.passed(frequency).max(axis=1) >= LEAST]
    factor = _largest(np.eye(AXES) - law.plant(frequency) @ law.step(frequency))
    return Contraction(frequency, factor, factor if doubt is None else _bound(law, doubt, frequency, np.ones(1))[0])


def cautious(law: PathLaw, doubt: Doubt) -> PathLaw:
    """Return a law with its Q lowered wherever errors shrink more with less of it, for all that the models may be.

    Of G_K G_M it undoes the part with which errors up to the cut-off shrink most.

    Parameters
    ----------
    law : PathLaw
    doubt : Doubt

    Returns
    -------
    PathLaw
        Its Q is still without phase.  Where nothing would make errors shrink, nothing is learned.
    """
    frequency = np.linspace(0.0, law.highest, LINES)
    found = []
    for share in SHARES if law.process is not None else SHARES[:1]:
        shared = replace(law, share=share)
        bounds = _bound(shared, doubt, frequency, PARTS)
        best = np.argmin(bounds, axis=0)
        left = bounds[best, np.arange(LINES)][frequency <= law.cutoff].mean()
        found.append((left, -share, replace(shared, caution=(frequency, np.tile(PARTS[best], (AXES, 1)).T))))
    return min(found, key=lambda each: each[:2])[2]


def _bound(law: PathLaw, doubt: Doubt, frequency: np.ndarray, parts: np.ndarray) -> np.ndarray:
    """Return the worst factor at each frequency with parts of the law's Q, shape (parts, bins)."""
    step = law.step(frequency)
    robot, spread = doubt.robot_at(frequency)
    couplings = [np.zeros_like(step)]
    if law.process is not None:
        couplings.append(law.process.coupling(frequency))
        couplings += [] if doubt.coupling is None else [doubt.coupling_at(frequency)]
    worst = np.stack([_largest(np.eye(AXES) - part * law.plant(frequency) @ step) for part in parts])
    for coupling in couplings:
        milled = np.linalg.inv(np.eye(AXES) - coupling)
        moved = milled @ diagonal(list(robot.T)) @ step
        unsure = _largest(milled * spread[:, None, :]) * _largest(step)
        there = [_largest(np.eye(AXES) - part * moved) + part * unsure for part in parts]
        worst = np.maximum(worst, np.stack(there))
    return worst


def interpolated(frequency: np.ndarray, known: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return complex values at other frequencies; beyond the ends as there.

    Parameters
    ----------
    frequency : array, shape (M,), Hz
    known : array, shape (bins,), Hz, rising
    values : complex array, shape (bins, ...), any unit

    Returns
    -------
    complex array, shape (M, ...), the values' unit
    """
    flat = values.reshape(len(known), -1).T
    found = [np.interp(frequency, known, each.real) + 1j * np.interp(frequency, known, each.imag) for each in flat]
    return np.stack(found, axis=-1).reshape(len(frequency), *values.shape[1:])


def _largest(matrices: np.ndarray) -> np.ndarray:
    """Return the largest singular value of each matrix, shape (bins,)."""
    return np.asarray(np.linalg.svd(matrices, compute_uv=False)[:, 0])
