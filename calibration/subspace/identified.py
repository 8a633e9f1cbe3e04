"""What identification gives: the model, what it rests on, and how well it fits."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from calibration.fit_measures import Fit, fit
from calibration.records import as_records
from calibration.subspace.order import Candidate
from calibration.subspace.pole_errors import PoleErrors, pole_errors
from calibration.subspace.realization import Method
from calibration.subspace.windows import Windows
from stagectl.models import InnovationModel


@dataclass(frozen=True)
class Identified:
    """A model from records, about their operating point.

    Parameters
    ----------
    model : InnovationModel
        Between deviations from the operating point.
    singular_values : array, shape (count,), 1, falling
        Those of the method; the order is where they end.
    candidates : tuple of Candidate
        Orders that were tried; none where the order was given.
    horizon : (past, future), samples
    input_offset, output_offset : arrays, shapes (m,) and (p,), the inputs' and the outputs' units
        The operating point: what was taken away from the records.
    moved_poles : int
        How many had to be moved into the unit circle; 0 for a stable estimate.
    by_riccati : bool
        Whether the Riccati equation had a stabilizing solution to start the gain from.
    method : "n4sid" or "moesp"
    windows : Windows
        Of the records, scaled.
    drives, responses : tuples of arrays, shapes (N, m) and (N, p), the inputs' and the outputs' units
        The records, as given.
    """

    model: InnovationModel
    singular_values: np.ndarray
    candidates: tuple[Candidate, ...]
    horizon: tuple[int, int]
    input_offset: np.ndarray
    output_offset: np.ndarray
    moved_poles: int
    by_riccati: bool
    method: Method
    windows: Windows
    drives: tuple[np.ndarray, ...]
    responses: tuple[np.ndarray, ...]

    @cached_property
    def fit(self) -> Fit:
        """How well it fits the records it was identified from; computed when first asked for."""
        coefficients = self.model.order * self.model.outputs
        return self._fit(self.drives, self.responses, coefficients)

    @cached_property
    def pole_errors(self) -> PoleErrors:
        """Standard errors of natural frequencies and damping ratios; computed when first asked for."""
        return pole_errors(self.windows, self.method, self.model.modes, self.model.order, self.model.rate)

    def assess(self, drive: np.ndarray | Sequence[np.ndarray], response: np.ndarray | Sequence[np.ndarray]) -> Fit:
        """Measure how well it fits other records, about the same operating point.

        Parameters
        ----------
        drive : array, shape (N, m), or a sequence of such, the inputs' units
        response : array, shape (N, p), or a sequence of such, the outputs' units
        """
        return self._fit(*as_records(drive, response), 0)

    def _fit(self, drives: Sequence[np.ndarray], responses: Sequence[np.ndarray], fitted: int) -> Fit:
        low = [drive - self.input_offset for drive in drives]
        high = [response - self.output_offset for response in responses]
        return fit(self.model, low, high, fitted=fitted)
