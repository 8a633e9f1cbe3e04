"""Prediction error methods: ARX by least squares, state spaces and transfer matrices by Gauss-Newton."""

from calibration.prediction_error.autoregression import Arx, arx
from calibration.prediction_error.refinement import Focus, Refined, refine

__all__ = ["Arx", "Focus", "Refined", "arx", "refine"]
