"""All of a model by prediction error, where a loop was closed: the efficient estimate of a system of that order."""

from collections.abc import Sequence

import numpy as np

from calibration.fit_measures import free_run
from calibration.prediction_error.refinement import Refined, refine
from calibration.state_space.model import InnovationModel
from calibration.subspace.weighting import WORSE

STEPS = 20
"""Gauss-Newton steps, at most."""


def refined_by_prediction(
    model: InnovationModel, drives: Sequence[np.ndarray], responses: Sequence[np.ndarray], has_direct: bool
) -> Refined | None:
    """Refine a stable model; None where the free run leaves more then, which a model too simple for its records does.

    Parameters
    ----------
    model : InnovationModel
    drives : sequence of arrays, each of shape (N, m), the inputs' units
    responses : sequence of arrays, each of shape (N, p), the outputs' units
    has_direct : bool
        Whether D is fitted.
    """
    refined = refine(model, drives, responses, direct=has_direct, iterations=STEPS)
    before, after = (_left(each, drives, responses) for each in (model, refined.model))
    return refined if after <= (1 + WORSE) * before else None


def _left(model: InnovationModel, drives: Sequence[np.ndarray], responses: Sequence[np.ndarray]) -> float:
    """Return what the free run leaves, re the outputs' own powers, summed over outputs."""
    left, power = (np.zeros(model.outputs) for _ in range(2))
    for drive, response in zip(drives, responses, strict=True):
        left += np.sum((response - free_run(model, drive, response)) ** 2, axis=0)
        power += np.sum(response**2, axis=0)
    return float(np.sum(left / power))
