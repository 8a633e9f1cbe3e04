"""A model of lower order to start a refinement from: the balanced predictor, cut."""

from dataclasses import replace

import numpy as np

from calibration.prediction_error.element import LARGEST_MODULUS, Element, balanced
from calibration.state_space.model import InnovationModel

INSIDE = 0.99
"""Modulus to which poles on or outside of the unit circle are brought at most."""


def reduced(model: InnovationModel, order: int) -> InnovationModel:
    """Cut a model, an ARX model of many lags for one, to fewer states by balancing its predictor.

    What is cut is small in the prediction; the free run may be far off until it is refined.  Poles on or outside of
    the unit circle are reflected in it, and K is halved until A - K C is stable as well.

    Parameters
    ----------
    model : InnovationModel
        With A - K C stable.
    order : int, 1 to the model's

    Source
    ------
    Moore 1981, "Principal component analysis in linear systems", IEEE Trans. Automatic Control 26, 17-32.
    """
    if not 1 <= order <= model.order:
        raise ValueError(f"order is {order}, must be 1 to the model's {model.order}")
    inlet = np.hstack([model.B - model.K @ model.D, model.K])
    whole = Element(model.A - model.K @ model.C, inlet, model.C, 0, model.inputs)
    if not (largest := float(np.abs(np.linalg.eigvals(whole.a)).max())) <= LARGEST_MODULUS:
        raise ValueError(f"the largest pole of A - K C has modulus {largest:.9g}, must be <= {LARGEST_MODULUS}")
    even, _ = balanced(whole)
    cut = Element(even.a[:order, :order], even.b[:order], even.c[:, :order], 0, model.inputs)
    gain = cut.b[:, model.inputs :]
    transition, inlet = _reflected(cut.system()), cut.b[:, : model.inputs] + gain @ model.D
    while not np.abs(np.linalg.eigvals(transition - gain @ cut.c)).max() <= LARGEST_MODULUS:
        gain = gain / 2
    return replace(model, A=transition, B=inlet, C=cut.c, K=gain)


def _reflected(transition: np.ndarray) -> np.ndarray:
    poles, vectors = np.linalg.eig(transition)
    size = np.abs(poles)
    if np.all(size <= LARGEST_MODULUS):
        return transition
    inside = np.where(size > LARGEST_MODULUS, poles / size * np.minimum(1 / np.maximum(size, 1e-3), INSIDE), poles)
    moved: np.ndarray = np.linalg.solve(vectors.T, (vectors * inside).T).T.real
    return moved
