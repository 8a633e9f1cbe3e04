"""State-space models from frequency responses with their variances, in continuous or discrete time."""

from calibration.frequency_domain.identify import identify_response, merged
from calibration.frequency_domain.response_model import ResponseModel

__all__ = ["ResponseModel", "identify_response", "merged"]
