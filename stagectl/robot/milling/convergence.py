"""Whether a learning law makes errors smaller from trial to trial, as the models and what is uncertain in them say."""

from dataclasses import dataclass

import numpy as np

from stagectl.robot.milling.learning import AXES, LearningLaw

LINES = 400
"""Frequencies looked at."""


@dataclass(frozen=True, eq=False)
class Doubt:
    """How far off the models may be.

    Parameters
    ----------
    frequency : array, shape (bins,), Hz, rising
    robot : array, shape (bins, 3), 1
        |G_R - its model| of each direction: measured response against model, and its uncertainty.
    process : float, 1
        Part of G_K G_M by which it may be larger or smaller.
    """

    frequency: np.ndarray
    robot: np.ndarray
    process: float

    def of_robot(self, frequency: np.ndarray) -> np.ndarray:
        """Return the doubt about G_R at frequencies, shape (bins,), Hz: shape (bins, 3); beyond the ends as there."""
        return np.stack([np.interp(frequency, self.frequency, each) for each in self.robot.T], axis=-1)


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

    Looked at are frequencies from rest to `law.highest`; above, nothing is learned and errors stay as they are.

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
    The doubt about G_R comes in by the triangle inequality, that about G_K G_M by its ends.
    """
    frequency = np.linspace(0.0, law.highest, LINES)
    step, plant = law.step(frequency), law.plant(frequency)
    factor = _largest(np.eye(AXES) - plant @ step)
    if doubt is None:
        return Contraction(frequency, factor, factor)
    robot = np.stack([axis.response(frequency) for axis in law.axes], axis=-1)
    coupling = np.zeros_like(plant) if law.process is None else law.process.coupling(frequency)
    bound = factor
    for share in (1.0 - doubt.process, 1.0, 1.0 + doubt.process):
        milled = np.linalg.inv(np.eye(AXES) - share * coupling)
        missed = _largest(np.eye(AXES) - (milled * robot[:, None, :]) @ step)
        unsure = _largest(milled * doubt.of_robot(frequency)[:, None, :]) * _largest(step)
        bound = np.maximum(bound, missed + unsure)
    return Contraction(frequency, factor, bound)


def _largest(matrices: np.ndarray) -> np.ndarray:
    """Return the largest singular value of each matrix, shape (bins,)."""
    return np.asarray(np.linalg.svd(matrices, compute_uv=False)[:, 0])
