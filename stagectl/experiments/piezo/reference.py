"""The wanted position of a whole run, from a few words or from a file."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ctlblocks.recording import Recording
from rigkit.foreign_record import read_signals
from stagectl.config import StageConfig
from stagectl.experiments.piezo.timeline import Timeline


def wanted_position(config: StageConfig, timeline: Timeline) -> Recording:
    """Return the wanted position of every axis over a run: the file's first value before it, its last after it.

    A file of another rate is interpolated between its samples.  A CSV may be this program's own, or have a first row of
    names and a column of time in s; a WAV holds m.

    Parameters
    ----------
    config : StageConfig
    timeline : Timeline

    Raises
    ------
    ValueError : the file has not a channel an axis in m, or leaves the travel.
    """
    axes = config.stage.axes
    names = tuple(f"wanted_{axis}" for axis in axes)
    if config.reference.signal == "hold":
        data = np.tile(np.resize(config.reference.position, len(axes)), (timeline.total, 1))
        return Recording(names, ("m",) * len(axes), timeline.rate, data)
    given = _by_axis(read_signals(Path(config.reference.signal)), config.reference.signal, axes)
    if any(unit not in ("m", "1") for unit in given.units):
        raise ValueError(f"{config.reference.signal}: units are {', '.join(given.units)}, must be m")
    low, high = config.limits.travel
    if not (given.data.min() >= low and given.data.max() <= high):
        raise ValueError(
            f"{config.reference.signal}: positions are {given.data.min():.4g} to {given.data.max():.4g} m, must be "
            f"within limits.travel {low:g} to {high:g} m"
        )
    time = (np.arange(timeline.total) - timeline.begin) / timeline.rate
    at = np.arange(len(given.data)) / given.rate
    data = np.column_stack([np.interp(time, at, channel) for channel in given.data.T.astype(float)])
    return Recording(names, ("m",) * len(axes), timeline.rate, data)


def _by_axis(given: Recording, path: str, axes: Sequence[str]) -> Recording:
    """Return the channels in the order of the axes: by their names, or as they come where none is named so."""
    names = {name.lower().removeprefix("wanted_").removeprefix("reference_"): name for name in given.names}
    if all(axis in names for axis in axes):
        return given.select([names[axis] for axis in axes])
    if len(given.names) != len(axes):
        raise ValueError(
            f"{path}: channels are {', '.join(given.names)}, must be {len(axes)}, or have {', '.join(axes)} among them"
        )
    return given
