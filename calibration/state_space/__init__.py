"""State-space models in innovation form: the record that identification ends in, for whoever has a use for one."""

from calibration.state_space.model import InnovationModel

__all__ = ["InnovationModel"]
