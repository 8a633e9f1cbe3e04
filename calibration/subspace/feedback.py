"""Whether inputs follow from outputs: a loop that was closed while records were made."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calibration.subspace.explained import explained
from calibration.subspace.lagged import OWN, lagged
from calibration.subspace.periodic import periodic

LAGS, OF_INNOVATIONS = 30, 10
"""Lags of the inputs' own past, and of the outputs' innovations, that each input is explained by."""
CHANCE = 1e-6
"""Probability of what innovations tell of an input by chance, above which it is none of theirs."""
HARM = 1e-5
"""Product of the part that they tell of what is new of it and the outputs' noise, below which a model is none the worse
for the loop."""


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

    @property
    def sentences(self) -> tuple[str, ...]:
        """Verdicts on these inputs, one each."""
        return tuple(
            f"input {channel + 1} follows from the outputs, which predict {100 * self.share[channel]:.0f} % of its "
            "innovations: a loop was closed"
            for channel in self.inputs
        )


def feedback(drives: Sequence[np.ndarray], responses: Sequence[np.ndarray]) -> Feedback:
    """Tell how much the innovations of the outputs foretell of the inputs beside the inputs' own past.

    Innovations are what an ARX model leaves, and what it leaves is free of the input of the same sample, which a direct
    term would put there.  Of records too short for that nothing is found, nor of inputs that repeat themselves exactly:
    noise would have gone around a loop and into them.

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
    found = explained(own[rows], past, later[rows])
    share = np.where(periodic(drives), 0.0, found.share)
    return Feedback(share, found.probability, float(noise.max()))
