"""Prefilters from what a run without compensation shows of the robot's deflection, and the file that keeps them."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ctlblocks.recording import Recording
from rigkit import atomic
from rigkit.json_file import read_json
from rigkit.json_text import json_text
from stagectl.experiments.piezo.lasers import lateness
from stagectl.stage.disturbance import disturbance
from stagectl.stage.prefilter import Prefilter, prefilter

if TYPE_CHECKING:
    from stagectl.experiments.piezo.setup import Setup

PREFILTER = "prefilter.json"
"""In a run's folder."""
_NUMBERS = "forward", "left", "without"
_MOST_TAPS, _MOST_SPACING = 1_000, 10_000


def learned(record: Recording, made: "Setup") -> tuple[Prefilter | None, ...]:
    """Return the prefilter of each axis for the deflection in a recording; none where the loop alone does as well.

    Parameters
    ----------
    record : Recording
        Of a run without compensation: laser (`absolute_*`) and `position_*` of each axis.
    made : Setup

    Raises
    ------
    ValueError : it is too short to tell frequencies apart, or nothing says what was heard of the stage.
    """
    config, begin = made.config, made.timeline.begin
    found: list[Prefilter | None] = []
    for axis, design, measured in zip(config.stage.axes, made.designs, made.measured, strict=True):
        if measured is None:
            raise ValueError(f"the model of {axis} does not hold the measured response of the stage: calibrate again")
        laser, position = record.select([f"absolute_{axis}", f"position_{axis}"]).data[begin:].T.astype(float)
        seen = disturbance(laser - position, record.rate)
        found.append(prefilter(design, config.outer, seen, lateness(config), measured))
    return tuple(found)


def write_prefilters(path: Path, axes: Sequence[str], rate: float, filters: Sequence[Prefilter | None]) -> None:
    """Write prefilters, whole or not at all.

    Parameters
    ----------
    path : Path
    axes : sequence of str
    rate : float, samples/s
    filters : sequence of Prefilter or None
        One of each an axis.
    """
    kept = {axis: None if each is None else _values(each) for axis, each in zip(axes, filters, strict=True)}
    atomic.write(path, json_text({"rate": rate, "axes": kept}) + "\n")


def read_prefilters(path: Path, axes: Sequence[str], rate: float) -> tuple[Prefilter | None, ...]:
    """Read the prefilters of a stage's axes.

    Parameters
    ----------
    path : Path
    axes : sequence of str
    rate : float, samples/s

    Raises
    ------
    ValueError : it is no such file, is of another rate or other axes, or has what is no filter.
    """
    content: dict[str, Any] = read_json(path, dict)
    kept = content.get("axes")
    if not isinstance(kept, dict):
        raise ValueError(f"{path} is no file of prefilters: it has no axes; `stagectl run` writes {PREFILTER}")
    if content.get("rate") != rate:
        raise ValueError(f"{path}: rate is {content.get('rate')}, must be {rate:g} samples/s, the stage's")
    if list(kept) != list(axes):
        raise ValueError(f"{path}: the axes are {', '.join(kept)}, must be {', '.join(axes)}, the stage's")
    return tuple(None if each is None else _prefilter(each, f"{path}: {axis}") for axis, each in kept.items())


def _values(each: Prefilter) -> dict[str, Any]:
    numbers = {name: getattr(each, name) for name in _NUMBERS}
    return {"spacing": each.spacing, **numbers, "taps": each.taps.tolist()}


def _prefilter(values: Any, name: str) -> Prefilter:
    try:
        taps = np.array(values["taps"], float)
        spacing, numbers = values["spacing"], [float(values[each]) for each in _NUMBERS]
    except (TypeError, KeyError, ValueError) as fault:
        raise ValueError(f"{name} is no prefilter: {fault!r}") from None
    is_whole = isinstance(spacing, int) and 1 <= spacing <= _MOST_SPACING
    if not (is_whole and taps.ndim == 1 and 1 <= len(taps) <= _MOST_TAPS and np.isfinite([*taps, *numbers]).all()):
        raise ValueError(
            f"{name}: a prefilter has 1 to {_MOST_TAPS} finite taps at a spacing of 1 to {_MOST_SPACING} samples"
        )
    if not abs(taps.sum() - 1.0) <= 1e-3:
        raise ValueError(f"{name}: the taps' sum is {taps.sum():.6g}, must be 1: a reference at rest is kept")
    return Prefilter(taps, spacing, *numbers)
