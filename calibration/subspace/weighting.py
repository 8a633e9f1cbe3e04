"""Inputs and direct term again, weighted by the noise's own colour."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calibration.subspace.ahead import offset, regress_ahead
from calibration.subspace.estimate import Estimate
from calibration.subspace.kalman_gain import Gain
from calibration.subspace.modal import modal
from calibration.subspace.modal_regression import responses
from calibration.subspace.regression import Terms
from calibration.subspace.response import CONDITION, EXACT

WORSE = 0.02
"""Part by which the power that the free run leaves may grow: what noise explains, and a model too simple does not."""


def left_by_free_run(
    estimate: Estimate, drives: Sequence[np.ndarray], measured: Sequence[np.ndarray]
) -> list[np.ndarray]:
    """Return what the free run leaves of each record: arrays of shape (N, p), 1.

    Parameters
    ----------
    estimate : Estimate
    drives : sequence of arrays, each of shape (N, m), 1
    measured : sequence of arrays, each of shape (N, p), 1
    """
    modes = modal(estimate.transition)
    return [
        response
        - estimate.constant
        - drive @ estimate.direct.T
        - responses(modes, estimate.outlet, estimate.inlet, drive, state)
        for drive, response, state in zip(drives, measured, estimate.states, strict=True)
    ]


def weighted(
    estimate: Estimate, gain: Gain, drives: Sequence[np.ndarray], measured: Sequence[np.ndarray], terms: Terms
) -> Estimate:
    """Fit B, D, offset and first states to the error one step ahead, with A, C and K held.

    For a system of this order that is the efficient estimate: noise that has passed through resonances is loud there.
    For a simpler model it trades the free run for the prediction; then, and where nothing is noise, the estimate is
    returned as it was.

    Parameters
    ----------
    estimate : Estimate
    gain : Gain
    drives : sequence of arrays, each of shape (N, m), 1
    measured : sequence of arrays, each of shape (N, p), 1
    terms : Terms
        What was fitted besides B.
    """
    predictor = modal(estimate.transition - gain.matrix @ estimate.outlet)
    power = sum(float(np.sum(response**2)) for response in measured)
    if predictor.condition > CONDITION or not estimate.left > EXACT * power:
        return estimate
    found, _ = regress_ahead(predictor, estimate.outlet, gain, drives, measured, terms)
    again = replace(
        estimate,
        inlet=found.inlet + gain.matrix @ found.direct,
        direct=found.direct,
        constant=offset(estimate.transition, estimate.outlet, gain, found.constant),
        states=found.states,
    )
    left = sum(float(np.sum(each**2)) for each in left_by_free_run(again, drives, measured))
    return replace(again, left=left) if left <= (1 + WORSE) * estimate.left else estimate
