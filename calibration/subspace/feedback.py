"""Whether inputs follow from outputs: a loop that was closed while records were made."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calibration.subspace.lagged import OWN, lagged

LAGS, OF_INNOVATIONS = 30, 10
"""Lags of the inputs' own past, and of the outputs' innovations, that each input is explained by."""
CHANCE = 1e-6
"""Probability of what innovations tell of an input by chance, above which it is none of theirs."""
HARM = 1e-5
"""Product of the part that they tell of what is new of it and the outputs' noise, below which a model is none the worse
for the loop."""
FORETOLD = 1e-8
"""Part of an input's power below which its own past tells all of it: nothing is left that outputs could."""


@dataclass(frozen=True)
class Feedback:
    """What the outputs' innovations tell of later inputs.

    Parameters
    ----------
    share : array, shape (m,), 0 to 1
        Of what each input's own past does not tell.
    probability : array, shape (m,), 0 to 1
        Of as much where there is no loop.
    noise : float, 0 to 1
        Power of the innovations over that of the output, of the output where that is most.
    """

    share: np.ndarray
    probability: np.ndarray
    noise: float

    @property
    def inputs(self) -> tuple[int, ...]:
        """Inputs that follow from outputs by as much as harms a model, counted from 0.

        Records that were filtered without delay foretell one another, too, and hold next to no noise.
        """
        is_told = (self.probability < CHANCE) & (self.share * self.noise > HARM)
        return tuple(int(each) for each in np.flatnonzero(is_told))


def feedback(drives: Sequence[np.ndarray], responses: Sequence[np.ndarray]) -> Feedback:
    """Tell how much the innovations of the outputs foretell of the inputs beside the inputs' own past.

    Innovations are what an ARX model leaves, and what it leaves is free of the input of the same sample, which a direct
    term would put there.  Of records too short for that nothing is found.

    Parameters
    ----------
    drives : sequence of arrays, each of shape (N, m), 1
        Without their mean.
    responses : sequence of arrays, each of shape (N, p), 1

    Source
    ------
    Granger 1969, "Investigating causal relations by econometric models and cross-spectral methods", Econometrica 37,
    424-438; Caines and Chan 1975, "Feedback between stationary stochastic processes", IEEE Trans. Autom. Control 20,
    498-508.
    """
    inputs, outputs = drives[0].shape[1], responses[0].shape[1]
    regressors, wanted, pieces = lagged(drives, responses, LAGS)
    own, later = regressors[:, OWN * outputs + inputs :], regressors[:, OWN * outputs : OWN * outputs + inputs]
    if len(regressors) < 4 * (regressors.shape[1] + OF_INNOVATIONS * outputs):
        return Feedback(np.zeros(inputs), np.ones(inputs), 0.0)
    innovations = wanted - regressors @ np.linalg.lstsq(regressors, wanted, rcond=None)[0]
    rows = np.concatenate([np.arange(first + OF_INNOVATIONS, last) for first, last in pieces])
    past = np.concatenate([innovations[rows - lag] for lag in range(1, OF_INNOVATIONS + 1)], axis=1)
    noise = np.mean(innovations**2, axis=0) / np.mean(wanted**2, axis=0)
    return _told(own[rows], past, later[rows], float(noise.max()))


def _told(own: np.ndarray, beside: np.ndarray, wanted: np.ndarray, noise: float) -> Feedback:
    """Compare what is left of some signals without and with further regressors, by an F test each."""
    from scipy.special import fdtrc  # slow to import

    without, both = (
        np.sum((wanted - known @ np.linalg.lstsq(known, wanted, rcond=None)[0]) ** 2, axis=0)
        for known in (own, np.concatenate([own, beside], axis=1))
    )
    is_open = without > FORETOLD * np.sum(wanted**2, axis=0)
    share = np.where(is_open, 1 - both / np.maximum(without, np.finfo(float).tiny), 0.0)
    freedom = len(wanted) - own.shape[1] - beside.shape[1]
    ratio = np.where(is_open, share / np.maximum(1 - share, 1e-12) * freedom / beside.shape[1], 0.0)
    return Feedback(share, np.asarray(fdtrc(beside.shape[1], freedom, ratio)), noise)
