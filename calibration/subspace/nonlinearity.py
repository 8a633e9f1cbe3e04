"""Whether a plant is linear: what squares and cubes of the signals tell of an output beside a linear model."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calibration.subspace.explained import explained, left
from calibration.subspace.lagged import OWN, lagged

LAGS = 20
"""Of the inputs, in the linear model."""
NEAR = 2
"""Lags whose powers are looked at: of the outputs from one on, of the inputs from none on."""
CHANCE = 1e-6
"""Probability of what they tell by chance, above which it is that."""
SHARE = 0.05
"""Part of what the linear model leaves that they must tell: less is no reason for another model."""


@dataclass(frozen=True)
class Nonlinearity:
    """What powers tell of each output.

    Parameters
    ----------
    share : array, shape (p,), 0 to 1
        Of what a linear model leaves.
    probability : array, shape (p,), 0 to 1
        Of as much where the plant is linear.
    """

    share: np.ndarray
    probability: np.ndarray

    @property
    def outputs(self) -> tuple[int, ...]:
        """Outputs of which they tell enough to be thought of, counted from 0."""
        is_told = (self.share > SHARE) & (self.probability < CHANCE)
        return tuple(int(each) for each in np.flatnonzero(is_told))

    @property
    def sentences(self) -> tuple[str, ...]:
        """Verdicts on these outputs, one each."""
        return tuple(
            f"output {channel + 1}: squares and cubes of the signals explain {100 * self.share[channel]:.0f} % of the "
            "residual of a linear model: the plant is not linear there"
            for channel in self.outputs
        )


def nonlinearity(drives: Sequence[np.ndarray], responses: Sequence[np.ndarray]) -> Nonlinearity:
    """Tell how much squares and cubes of outputs and inputs explain of what an ARX model leaves.

    What of the linear response an ARX model of this length leaves over, powers can seem to explain, but not on the half
    of the records that they were not fitted to: the least of both halves and the whole counts.  Of records too short
    for that nothing is found.

    Parameters
    ----------
    drives : sequence of arrays, each of shape (N, m), any unit
        Without their mean.
    responses : sequence of arrays, each of shape (N, p), any unit

    Source
    ------
    Ramsey 1969, "Tests for specification errors in classical linear least-squares regression analysis", J. Royal
    Statistical Society B 31, 350-371, with the regressors themselves in place of what is fitted.
    """
    inputs, outputs = drives[0].shape[1], responses[0].shape[1]
    regressors, wanted, _ = lagged(drives, responses, LAGS)
    near = np.concatenate(
        [regressors[:, : NEAR * outputs], regressors[:, OWN * outputs :][:, : (NEAR + 1) * inputs]], axis=1
    )
    if len(regressors) < 4 * (regressors.shape[1] + 2 * near.shape[1]):
        return Nonlinearity(np.zeros(outputs), np.ones(outputs))
    near = near / np.maximum(near.std(axis=0), np.finfo(float).tiny)
    linear, powers = np.column_stack([np.ones(len(near)), regressors]), np.concatenate([near**2, near**3], axis=1)
    found, half, both = explained(linear, powers, wanted), len(near) // 2, np.concatenate([linear, powers], axis=1)
    first, second = slice(0, half), slice(half, None)
    fresh = [
        1 - left(both, wanted, *sides) / np.maximum(left(linear, wanted, *sides), np.finfo(float).tiny)
        for sides in ((first, second), (second, first))
    ]
    return Nonlinearity(np.minimum(found.share, np.min(fresh, axis=0)).clip(0.0), found.probability)
