"""Subspace identification of state-space models in innovation form: MOESP, N4SID and PBSID."""

from calibration.subspace.examination import Examination, examine
from calibration.subspace.identified import Identified
from calibration.subspace.identify import identify
from calibration.subspace.realization import Method
from calibration.subspace.signals import Detrend

__all__ = ["Detrend", "Examination", "Identified", "Method", "examine", "identify"]
