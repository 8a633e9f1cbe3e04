"""Inputs, direct term and first states of a model whose A and C are known, by least squares on its free run."""

from collections.abc import Sequence

import numpy as np

from calibration.subspace.modal import modal
from calibration.subspace.modal_regression import regress, sums
from calibration.subspace.regression import Regression, Terms, regress_columns

CONDITION = 1e5
"""Of the modes' shapes: beyond it their sums of products have lost too many digits."""
EXACT = 1e-7
"""Part of the outputs' power: when less is left, sums of squares no longer tell how much."""


def fit_response(
    transition: np.ndarray,
    outlet: np.ndarray,
    drives: Sequence[np.ndarray],
    responses: Sequence[np.ndarray],
    terms: Terms,
) -> Regression:
    """Fit B, D, an offset and each record's first state to the outputs as simulated from the inputs alone.

    Parameters
    ----------
    transition : array, shape (n, n), 1
        A, stable.
    outlet : array, shape (p, n), 1
        C.
    drives : sequence of arrays, each of shape (N, m), 1
    responses : sequence of arrays, each of shape (N, p), 1
    terms : Terms
        Whether D and an offset of the outputs are fitted; they are 0 otherwise.
    """
    modes = modal(transition)
    if modes.condition < CONDITION:
        records = [sums(modes, drive, response) for drive, response in zip(drives, responses, strict=True)]
        found = regress(modes, outlet, records, terms)
        if found.left > EXACT * sum(float(np.trace(record.power)) for record in records):
            return found
    return regress_columns(transition, outlet, drives, responses, terms)
