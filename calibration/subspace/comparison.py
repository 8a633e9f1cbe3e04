"""A model held against records: what it makes of them, and how near that comes."""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from calibration.fit_measures import Fit, fit, free_run
from calibration.state_space.model import InnovationModel

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Comparison:
    """Records about the operating point of a model, and the model.

    Parameters
    ----------
    model : InnovationModel
    drives, responses : tuples of arrays, shapes (N, m) and (N, p), the inputs' and the outputs' units
        Deviations from the operating point.
    fitted : int
        Coefficients of the noise model that were fitted to these very records; 0 on fresh ones.
    """

    model: InnovationModel
    drives: tuple[np.ndarray, ...]
    responses: tuple[np.ndarray, ...]
    fitted: int = 0

    @cached_property
    def fit(self) -> Fit:
        """Measures of free run and prediction, and tests of the residuals."""
        return fit(self.model, self.drives, self.responses, fitted=self.fitted)

    @cached_property
    def free_run(self) -> tuple[np.ndarray, ...]:
        """Responses to the drives alone, from the states that fit best: arrays of shape (N, p), the outputs' units."""
        pairs = zip(self.drives, self.responses, strict=True)
        return tuple(free_run(self.model, drive, response) for drive, response in pairs)

    @cached_property
    def residuals(self) -> tuple[np.ndarray, ...]:
        """What the prediction one step ahead leaves, from the states that fit best: arrays of shape (N, p)."""
        pairs = zip(self.drives, self.responses, strict=True)
        return tuple(
            response - self.model.predict(drive, response, self.model.initial_predictor_state(drive, response))
            for drive, response in pairs
        )

    def draw(self) -> "Figure":
        """Return a figure of the first record: measured, free run and difference, output by output."""
        from calibration.subspace.drawing import comparison_figure

        figure: Figure = comparison_figure(self)
        return figure

    def __str__(self) -> str:
        """Return a line an output."""
        from calibration.subspace.telling import fit_lines

        return "\n".join(fit_lines(self.model, self.fit))
