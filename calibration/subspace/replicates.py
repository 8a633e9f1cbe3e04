"""Models of all but one segment of the records in turn: how far they lie apart tells how sure responses are."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from calibration.one_thread import on_one_thread
from calibration.state_space.model import InnovationModel
from calibration.state_space.response_errors import ResponseErrors
from calibration.subspace.estimate import Estimate, compress
from calibration.subspace.kalman_gain import Gain, is_stable
from calibration.subspace.predicted import estimated
from calibration.subspace.realization import Method
from calibration.subspace.regression import Terms
from calibration.subspace.signals import Signals
from calibration.subspace.weighting import weighted
from calibration.subspace.windows import Windows

SHORTEST = 4
"""Samples a state of what is left of a record before and after a segment; shorter rests are left out as well."""


@dataclass(frozen=True, eq=False)
class Resampling:
    """What a model was estimated from, and how, so that it can be again from less.

    Parameters
    ----------
    windows : Windows
        Of the records, in segments.
    data : Signals
        The records.
    method : "n4sid", "moesp" or "pbsid"
    terms : Terms
    order : int
    """

    windows: Windows
    data: Signals
    method: Method
    terms: Terms
    order: int

    @cached_property
    def models(self) -> tuple[InnovationModel, ...]:
        """The models without each segment, in the records' units at one sample a second, K as it came."""
        return self._models()

    @on_one_thread
    def _models(self) -> tuple[InnovationModel, ...]:
        return tuple(self._without(segment) for segment in range(self.windows.segments))

    def response_errors(self, model: InnovationModel, frequency: np.ndarray) -> ResponseErrors:
        """Return standard errors of the frequency response.

        Parameters
        ----------
        model : InnovationModel
            Of all segments.
        frequency : array, shape (bins,), Hz
        """
        whole = model.frequency_response(frequency)
        apart = np.array([each.frequency_response(frequency / model.rate) for each in self.models])
        size = np.maximum(np.abs(whole), np.finfo(float).tiny)
        return ResponseErrors(spread(np.abs(apart)), spread(np.angle(apart * whole.conj() / size)))

    def simulation_errors(self, drive: np.ndarray) -> np.ndarray:
        """Return standard errors of what the model responds to inputs from rest, the outputs' units, shape (N, p).

        Parameters
        ----------
        drive : array, shape (N, m), the inputs' units
        """
        return spread(np.array([model.simulate(drive) for model in self.models]))

    def _without(self, segment: int) -> InnovationModel:
        drives, responses = self._rest(segment)
        compressed = compress(self.windows, self.method, without=[segment])
        found = estimated(compressed, self.order, drives, responses, self.terms)
        if is_stable(found.transition):
            found = weighted(found, found.gain, drives, responses, self.terms)
        return in_units(found, found.gain, self.data, 1.0)

    def _rest(self, segment: int) -> tuple[list[np.ndarray], list[np.ndarray]]:
        """Return records without a segment, cut in two where it lies inside."""
        place = self.windows.samples(segment)
        sides: tuple[list[np.ndarray], list[np.ndarray]] = [], []
        for side, records in zip(sides, (self.data.drives, self.data.responses), strict=True):
            for number, record in enumerate(records):
                cut = place[1:] if number == place[0] else (len(record), len(record))
                side.extend(_long(record, cut, SHORTEST * self.order))
        return sides


def spread(without: np.ndarray) -> np.ndarray:
    """Return the standard error from estimates without each segment, shape (segments, ...): shape (...).

    Source
    ------
    Efron 1982, The Jackknife, the Bootstrap and Other Resampling Plans, chapter 3.
    """
    count = len(without)
    away = np.abs(without - without.mean(axis=0)) ** 2
    error: np.ndarray = np.sqrt((count - 1) / count * np.sum(away, axis=0))
    return error


def in_units(found: Estimate, gain: Gain, data: Signals, rate: float) -> InnovationModel:
    """Return an estimate as a model in the records' units.

    Parameters
    ----------
    found : Estimate
    gain : Gain
    data : Signals
    rate : float, samples/s
    """
    small, large = data.input_scale, data.output_scale
    return InnovationModel(
        found.transition,
        found.inlet / small,
        large[:, None] * found.outlet,
        large[:, None] * found.direct / small,
        gain.matrix / large,
        rate,
        large[:, None] * gain.innovation * large,
    )


def _long(record: np.ndarray, cut: Sequence[int], shortest: int) -> Iterator[np.ndarray]:
    """Yield what is before and after a cut, where that is long enough."""
    for part in (record[: cut[0]], record[cut[1] :]):
        if len(part) > shortest:
            yield part
