"""What an axis was heard to do: above the frequencies of its models, within them, and by the laser."""

from collections.abc import Callable, Sequence

import numpy as np

from calibration.stage_axes.above import RESOLUTION, HeardResponse, heard_response
from calibration.stage_axes.experiment import Excited, Experiment, above_band
from stagectl.config import StageConfig
from stagectl.deflection import DeflectionReference
from stagectl.stage.measured_response import MeasuredResponse

_Signal = Callable[[Excited], np.ndarray]
_Band = tuple[float, float]


def heard_above(config: StageConfig, experiment: Experiment, signal: np.ndarray) -> HeardResponse:
    """Return the response of a signal to the chirp above the band.

    Parameters
    ----------
    config : StageConfig
    experiment : Experiment
    signal : array, shape (N,), m
        As recorded with that chirp.
    """
    return heard_response([experiment.above.drive[:, 0]], [signal], config.stage.rate, above_band(config))


def heard_by_laser(config: StageConfig, axis: int, experiment: Experiment) -> HeardResponse | None:
    """Return the response, above the band, of the motion that a laser and the plate's own sensor see differently.

    Parameters
    ----------
    config : StageConfig
    axis : int, counted from 0
    experiment : Experiment

    Returns
    -------
    HeardResponse or None, m/m
        None without a laser.
    """
    above = experiment.above
    return heard_above(config, experiment, _seen(config, above)[:, axis]) if above.absolute.any() else None


def heard_everywhere(config: StageConfig, axis: int, experiment: Experiment) -> MeasuredResponse:
    """Return what was heard of an axis with closed inner loop, from the band's beginning to the highest chirp's end.

    Parameters
    ----------
    config : StageConfig
    axis : int, counted from 0
    experiment : Experiment
    """
    low, high = config.characterisation.band
    parts = [((max(low, RESOLUTION), high), [*experiment.learned, experiment.fresh])]
    parts.append((above_band(config), [experiment.above]))
    position = [_heard(config, band, chirps, lambda each: each.position[:, axis]) for band, chirps in parts]
    seen = [_heard(config, band, chirps, lambda each: _seen(config, each)[:, axis]) for band, chirps in parts]
    frequency = np.concatenate([each.frequency for each in position]) + RESOLUTION / 2
    return MeasuredResponse(frequency, *(np.concatenate([each.response for each in side]) for side in (position, seen)))


def _heard(config: StageConfig, band: _Band, chirps: Sequence[Excited], signal: _Signal) -> HeardResponse:
    drives, answers = [each.drive[:, 0] for each in chirps], [signal(each) for each in chirps]
    return heard_response(drives, answers, config.stage.rate, band)


def _seen(config: StageConfig, heard: Excited) -> np.ndarray:
    """Return what compensation takes for the robot's motion, shape (N, axes), m; zeros without a laser."""
    compensation, reference = (
        DeflectionReference(config.deflection, heard.position.shape[1]),
        np.zeros_like(heard.position),
    )
    if heard.absolute.any():
        compensation.prepare(config.stage.rate, len(reference))
        absolute, position = (np.ascontiguousarray(each) for each in (heard.absolute, heard.position))
        compensation.process(np.zeros_like(position), absolute, position, reference)
    return reference
