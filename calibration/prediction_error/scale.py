"""Units in which every signal of a fit is of size one."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from calibration.state_space.model import InnovationModel


@dataclass(frozen=True, eq=False)
class Scale:
    """Units in which every signal is of size one, as fits want them.

    Parameters
    ----------
    drive : array, shape (m,), the inputs' units
    response : array, shape (p,), the outputs' units
    """

    drive: np.ndarray
    response: np.ndarray

    def of_drives(self, drives: Sequence[np.ndarray]) -> list[np.ndarray]:
        """Return drives, each of shape (N, m), in these units and contiguous."""
        return [np.ascontiguousarray(drive / self.drive) for drive in drives]

    def of_responses(self, responses: Sequence[np.ndarray]) -> list[np.ndarray]:
        """Return responses, each of shape (N, p), in these units and contiguous."""
        return [np.ascontiguousarray(response / self.response) for response in responses]

    def applied(self, model: InnovationModel) -> InnovationModel:
        """Return a model in these units."""
        return self._changed(model, 1 / self.drive, 1 / self.response)

    def removed(self, model: InnovationModel) -> InnovationModel:
        """Return a model that is in these units in SI units."""
        return self._changed(model, self.drive, self.response)

    @staticmethod
    def _changed(model: InnovationModel, drive: np.ndarray, response: np.ndarray) -> InnovationModel:
        return replace(
            model,
            B=model.B / drive,
            C=model.C * response[:, None],
            D=model.D * response[:, None] / drive,
            K=model.K / response,
            innovation=model.innovation * np.outer(response, response),
        )


def scale_of(drives: Sequence[np.ndarray], responses: Sequence[np.ndarray]) -> Scale:
    """Return the rms of each channel over all records; 1 for one that is zero throughout.

    Parameters
    ----------
    drives : sequence of arrays, shape (N, m), the inputs' units
    responses : sequence of arrays, shape (N, p), the outputs' units
    """
    sizes = [np.sqrt(np.mean(np.concatenate(records) ** 2, axis=0)) for records in (drives, responses)]
    return Scale(*(np.where(size > 0, size, 1.0) for size in sizes))
