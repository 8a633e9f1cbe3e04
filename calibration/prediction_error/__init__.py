"""Prediction error methods: ARX by least squares, state spaces and transfer matrices by Gauss-Newton."""

from calibration.prediction_error.autoregression import Arx, arx
from calibration.prediction_error.pole_errors import ModeErrors
from calibration.prediction_error.reduction import reduced
from calibration.prediction_error.refinement import Focus, Refined, refine
from calibration.prediction_error.transfer_matrix import TransferMatrix, identify_transfer_matrix

__all__ = [
    "Arx",
    "Focus",
    "ModeErrors",
    "Refined",
    "TransferMatrix",
    "arx",
    "identify_transfer_matrix",
    "reduced",
    "refine",
]
