"""What an axis was heard to do: above the frequencies of its models, within them, and by the laser."""

from collections.abc import Sequence

import numpy as np

from calibration.stage_axes.above import RESOLUTION, HeardResponse, heard_response
from calibration.stage_axes.experiment import Excited, Experiment, above_band
from stagectl.config import StageConfig
from stagectl.experiments.piezo.deflection import DeflectionReference
from stagectl.stage.measured_response import MeasuredResponse


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


def heard_everywhere(
    config: StageConfig, axis: int, experiment: Experiment, above: HeardResponse, seen: HeardResponse | None
) -> MeasuredResponse:
    """Return what was heard of an axis with closed inner loop, from the band's beginning to the highest chirp's end.

    Parameters
    ----------
    config : StageConfig
    axis : int, counted from 0
    experiment : Experiment
    above : HeardResponse, m/m
        Of the axis' position, above the band.
    seen : HeardResponse or None, m/m
        As of `heard_by_laser`.
    """
    chirps, nothing = [*experiment.learned, experiment.fresh], np.zeros(len(above.response), complex)
    position = _within(config, chirps, [each.position[:, axis] for each in chirps])
    robot = _within(config, chirps, [_seen(config, each)[:, axis] for each in chirps])
    frequency = np.concatenate([position.frequency, above.frequency]) + RESOLUTION / 2
    responses = (position.response, above.response), (robot.response, nothing if seen is None else seen.response)
    return MeasuredResponse(frequency, *(np.concatenate(each) for each in responses))


def _within(config: StageConfig, chirps: Sequence[Excited], signals: Sequence[np.ndarray]) -> HeardResponse:
    """Return the response within the models' band of signals that were recorded with chirps."""
    low, high = config.characterisation.band
    drives = [each.drive[:, 0] for each in chirps]
    return heard_response(drives, signals, config.stage.rate, (max(low, RESOLUTION), high))


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
