"""Whether a learning law makes errors smaller from trial to trial, as the models and what is uncertain in them say."""

from dataclasses import dataclass

import numpy as np

from stagectl.robot.milling.axis_model import diagonal
from stagectl.robot.milling.learning import AXES, LearningLaw

LINES = 400
"""Frequencies looked at."""
LEAST = 0.01
"""Of Q and the gain, from which on a frequency counts as learned."""


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
    process : float, 1
        Part of G_K G_M by which it may be larger or smaller.
    """

    frequency: np.ndarray
    robot: np.ndarray
    spread: np.ndarray
    process: float

    def at(self, frequency: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return response and spread, both of shape (bins, 3), at frequencies, shape (bins,), Hz; at rest it is 1."""
        known = np.concatenate([[0.0], self.frequency])
        responses = np.concatenate([np.ones((1, AXES)), self.robot])
        spreads = np.concatenate([np.zeros((1, AXES)), self.spread])
        found = [np.stack([np.interp(frequency, known, each) for each in side.T], axis=-1) for side in (
            responses.real, responses.imag, spreads)]  # fmt: skip
        return found[0] + 1j * found[1], found[2]


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


def contraction(law: LearningLaw, doubt: Doubt | None = None) -> Contraction:
    """Hold a law against the models, and against all that they might be instead.

    Looked at are frequencies at which at least a hundredth of an error is learned; where it is less, errors stay as
    they are.

    Parameters
    ----------
    law : LearningLaw
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
    P is that of the measured response as well as that of the models; the response's spread comes in by the triangle
    inequality, the doubt about G_K G_M by its ends.
    """
    frequency = np.linspace(0.0, law.highest, LINES)
    frequency = frequency[law.passed(frequency) >= LEAST]
    step = law.step(frequency)
    factor = _largest(np.eye(AXES) - law.plant(frequency) @ step)
    if doubt is None:
        return Contraction(frequency, factor, factor)
    robot, spread = doubt.at(frequency)
    coupling = np.zeros_like(step) if law.process is None else law.process.coupling(frequency)
    bound = factor
    for share in (1.0 - doubt.process, 1.0, 1.0 + doubt.process):
        milled = np.linalg.inv(np.eye(AXES) - share * coupling)
        missed = _largest(np.eye(AXES) - milled @ diagonal(list(robot.T)) @ step)
        bound = np.maximum(bound, missed + _largest(milled * spread[:, None, :]) * _largest(step))
    return Contraction(frequency, factor, bound)


def _largest(matrices: np.ndarray) -> np.ndarray:
    """Return the largest singular value of each matrix, shape (bins,)."""
    return np.asarray(np.linalg.svd(matrices, compute_uv=False)[:, 0])
