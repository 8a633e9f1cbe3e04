"""What identification gives: the model, what it rests on, and how well it fits."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from calibration.fit_measures import Fit
from calibration.gaps import without_gaps
from calibration.records import as_records, sides_of
from calibration.state_space.conversion import to_control, to_scipy
from calibration.state_space.model import InnovationModel
from calibration.state_space.response_errors import ResponseErrors
from calibration.subspace import telling
from calibration.subspace.comparison import Comparison
from calibration.subspace.delays import Delays, held_back
from calibration.subspace.diagnosis import Diagnosis, diagnose
from calibration.subspace.excitation import persistence
from calibration.subspace.feedback import Feedback
from calibration.subspace.nonlinearity import nonlinearity
from calibration.subspace.order import Candidate
from calibration.subspace.pole_errors import PoleErrors, pole_errors
from calibration.subspace.realization import Method
from calibration.subspace.replicates import Resampling

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from calibration.prediction_error.refinement import Refined

STRETCH = 8
"""Samples for each state that a record, or a stretch between gaps, must have: its first state is fitted to it."""
_FIELDS = ("frequency", "frequency_error", "damping", "damping_error")


@dataclass(frozen=True, repr=False)
class Identified:
    """A model from records, about their operating point.

    Parameters
    ----------
    model : InnovationModel
        Between deviations from the operating point, delays included.
    core : InnovationModel
        The same without delays: of the order that was chosen.
    delays : tuple of int, samples
        Of each input.
    heard : Delays or None
        What the delays rest on; None where they were given, or nothing could be told.
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
    method : "n4sid", "moesp" or "pbsid"
    feedback : Feedback
        Whether inputs follow from outputs.
    resampling : Resampling
        From which segments of the records it came, and how.
    drives, responses : tuples of arrays, shapes (N, m) and (N, p), the inputs' and the outputs' units
        The records, without gaps, outliers, and what `detrend` takes from each.
    outliers : tuple of arrays of bool, shape (N, p)
        Where samples of outputs were replaced.
    refined : Refined, optional
        How the model came of the subspace's by prediction error, where it did.
    """

    model: InnovationModel
    core: InnovationModel
    delays: tuple[int, ...]
    heard: Delays | None
    singular_values: np.ndarray
    candidates: tuple[Candidate, ...]
    horizon: tuple[int, int]
    input_offset: np.ndarray
    output_offset: np.ndarray
    moved_poles: int
    by_riccati: bool
    method: Method
    feedback: Feedback
    resampling: Resampling
    drives: tuple[np.ndarray, ...]
    responses: tuple[np.ndarray, ...]
    outliers: tuple[np.ndarray, ...]
    refined: "Refined | None" = None

    @property
    def candidates_ran_free(self) -> bool:
        """Whether the free run counted in the choice, and not the prediction alone."""
        return any(each.free_run != each.one_step for each in self.candidates)

    @cached_property
    def own(self) -> Comparison:
        """It and the records it was identified from."""
        return self._beside(self.drives, self.responses, self.core.order * self.model.outputs)

    @property
    def fit(self) -> Fit:
        """How well it fits the records it was identified from; computed when first asked for."""
        return self.own.fit

    @cached_property
    def diagnosis(self) -> Diagnosis:
        """What is to be thought of it and of the records; computed when first asked for."""
        samples = sum(len(drive) for drive in self.drives)
        excites = persistence([drive - self.input_offset for drive in self.drives])
        loop = self.feedback, self.method != "pbsid"
        data = self.resampling.data
        bent = nonlinearity(data.drives, data.responses)
        unheard = () if self.heard is None or self.feedback.inputs else self.heard.unheard
        return diagnose(self.fit, self.core.order, samples, excites, self.moved_poles, loop, (bent, unheard))

    @cached_property
    def pole_errors(self) -> PoleErrors:
        """Standard errors of natural frequencies and damping ratios; computed when first asked for."""
        if self.refined is not None:
            return PoleErrors(self.refined.errors.frequency, self.refined.errors.damping)
        return pole_errors(self.resampling.windows, self.method, self.core.modes, self.core.order, self.core.rate)

    def response_errors(self, frequency: np.ndarray) -> ResponseErrors:
        """Return standard errors of the frequency response; each can be taken for normal.

        They are of chance alone: where the order is too small the response is off by more, see `diagnosis`.

        Parameters
        ----------
        frequency : array, shape (bins,), Hz
        """
        frequency = np.asarray(frequency, float)
        if self.refined is not None:
            return self.refined.sensitivities.response_errors(self.core, frequency)
        return self.resampling.response_errors(self.core, frequency)

    def simulation_errors(self, u: Any) -> np.ndarray:
        """Return standard errors of what the model responds to inputs from rest, shape (N, p), the outputs' units.

        Parameters
        ----------
        u : array, shape (N, m) or (N,), list or table, the inputs' units
            Deviations from the operating point, as of `model.simulate`.
        """
        drive = held_back(as_records(u, u)[0][0], self.delays)
        if self.refined is not None:
            return self.refined.sensitivities.simulation_errors(self.core, drive)
        return self.resampling.simulation_errors(drive)

    def compare(self, u: Any, y: Any) -> Comparison:
        """Hold it against other records, about the same operating point.

        Parameters
        ----------
        u : array, shape (N, m) or (N,), list or table, or a sequence of such, the inputs' units
            As of `identify`, None where there are no inputs.
        y : array, shape (N, p) or (N,), list or table, or a sequence of such, the outputs' units

        Raises
        ------
        ValueError : other numbers of channels, lengths that differ, or records so short that any first state fits them.
        """
        inputs, outputs = sides_of(u, y)
        for name, side, wanted in (("input", inputs, self.model.inputs), ("output", outputs, self.model.outputs)):
            if side.records[0].shape[1] != wanted:
                raise ValueError(f"records have {side.records[0].shape[1]} {name}s, the model has {wanted}")
        told = STRETCH * max(1, self.core.order // self.model.outputs)
        drives, responses = without_gaps(inputs.records, outputs.records, at_least=told)
        if (shortest := min(map(len, drives))) < told:
            raise ValueError(f"a record has {shortest} samples, must have {told}: any first state would fit fewer")
        return self._beside(drives, responses, 0)

    def residuals(self) -> tuple[np.ndarray, ...]:
        """Return what the prediction one step ahead leaves of the records: arrays of shape (N, p), outputs' units."""
        return self.own.residuals

    def poles(self) -> np.ndarray:
        """Return poles with what they mean and their standard errors; those of delays, at zero, are left out.

        Returns
        -------
        structured array, shape (modes,)
            Fields `pole` (1), `frequency` and `frequency_error` (Hz), `damping` and `damping_error` (1); one entry a
            mode, by rising natural frequency.
        """
        modes, errors = self.core.modes, self.pole_errors
        columns = (modes.pole, modes.frequency, errors.frequency, modes.damping, errors.damping)
        kinds = [("pole", complex), *((name, float) for name in _FIELDS)]
        return np.array(list(zip(*columns, strict=True)), dtype=kinds)

    def summary(self) -> str:
        """Return fits, modes with standard errors, and what is to be thought of them, in lines of text."""
        return telling.summary(self)

    def bode(self, frequency: np.ndarray | None = None) -> "Figure":
        """Return a figure of gain and phase, at frequencies in Hz, shape (bins,), where some are given.

        Without, from one period over the longest record on.  Shaded is where the plant's response lies nineteen times
        of twenty, see `response_errors`.
        """
        from calibration.subspace.drawing import bode_figure

        longest = max(len(each) for each in self.drives)
        grid = telling.frequencies(self.model, longest) if frequency is None else np.atleast_1d(frequency).astype(float)
        if not (grid.size and grid.min() >= 0 and grid.max() <= self.model.rate / 2):
            raise ValueError(f"frequency must be 0 to {self.model.rate / 2:g} Hz, half the rate")
        figure: Figure = bode_figure(self.model, grid, self.response_errors(grid) if self.model.inputs else None)
        return figure

    def draw_candidates(self) -> "Figure":
        """Return a figure of what each order and horizon that was tried left of the blocks that were held out.

        Raises
        ------
        ValueError : order and horizon were given.
        """
        from calibration.subspace.drawing import candidates_figure

        if not self.candidates:
            raise ValueError("order and horizon were given, there are no candidates to be drawn")
        taken = self.core.order, self.horizon[1]
        figure: Figure = candidates_figure(self.candidates, *taken, self.candidates_ran_free)
        return figure

    def to_control(self) -> Any:
        """Return a `control.StateSpace` of the model, from inputs to outputs; python-control must be installed."""
        return to_control(self.model)

    def to_scipy(self) -> Any:
        """Return a discrete `scipy.signal.StateSpace` of the model, from inputs to outputs."""
        return to_scipy(self.model)

    def save(self, path: str | Path) -> Path:
        """Write the model as an HDF5 model file, which `stagectl` and `read_model` take; return where it is."""
        from stagectl.models.model_file import write_model

        write_model(Path(path), self.model.described(method=self.method, order=str(self.core.order)))
        return Path(path)

    def __repr__(self) -> str:
        """Return a line."""
        return f"<Identified: {telling.title(self)}>"

    def _repr_html_(self) -> str:
        return telling.html(self)

    def _beside(self, drives: Sequence[np.ndarray], responses: Sequence[np.ndarray], fitted: int) -> Comparison:
        low = tuple(drive - self.input_offset for drive in drives)
        high = tuple(response - self.output_offset for response in responses)
        return Comparison(self.model, low, high, fitted)
