"""Records of drives and responses, as an estimator takes them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from stagectl.models import InnovationModel


def as_records(
    drive: np.ndarray | Sequence[np.ndarray], response: np.ndarray | Sequence[np.ndarray]
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Return drives and responses as lists of arrays, shapes (N, m) and (N, p), or refuse them.

    Parameters
    ----------
    drive : array, shape (N, m), the inputs' units, or a sequence of such
    response : array, shape (N, p), the outputs' units, or a sequence of such
    """
    drives, responses = _listed("drive", drive), _listed("response", response)
    if len(drives) != len(responses):
        raise ValueError(f"there are {len(drives)} drives and {len(responses)} responses, must be as many")
    for number, (u, y) in enumerate(zip(drives, responses, strict=True), start=1):
        if len(u) != len(y):
            raise ValueError(f"record {number}: drive has {len(u)} samples and response {len(y)}, must be as many")
    return drives, responses


def _listed(name: str, signals: np.ndarray | Sequence[np.ndarray]) -> list[np.ndarray]:
    parts = [signals] if isinstance(signals, np.ndarray) and signals.ndim < 3 else list(signals)
    arrays = [np.ascontiguousarray(part, float) for part in parts]
    if not arrays:
        raise ValueError(f"{name} has no record, must have at least one")
    for number, array in enumerate(arrays, start=1):
        if array.ndim != 2 or array.shape[1] != arrays[0].shape[-1] or array.size == 0:
            raise ValueError(f"{name} of record {number} has shape {array.shape}, must be (N, {arrays[0].shape[-1]})")
        if not (finite := np.isfinite(array).all(axis=1)).all():
            raise ValueError(f"{name} of record {number} is not finite at sample {int(finite.argmin())}")
    return arrays


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
