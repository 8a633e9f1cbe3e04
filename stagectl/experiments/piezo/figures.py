"""What a run comes to, from its recordings: errors of position and tool, and what compensation has bettered."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from ctlblocks.recording import Recording
from stagectl.experiments.piezo.cell import RECORDING, UNCOMPENSATED
from stagectl.experiments.piezo.lasers import reads_laser
from stagectl.experiments.piezo.setup import Setup
from stagectl.tracking import tracking


def figures(records: Mapping[str, Recording], made: Setup) -> dict[str, Any]:
    """Return the figures of a run that other programs read.

    Parameters
    ----------
    records : mapping of str to Recording
        Its recordings, by name.
    made : Setup

    Returns
    -------
    dict
        `seconds` of the run proper that are recorded; `position_error` (reference less position) and `tool_error`
        (wanted less laser), each for each axis: mae, std, peak (m) and within (1); where it was also run
        uncompensated, `uncompensated_tool_error` and `improvement`, the ratio of the mean absolute errors, by axis;
        `prefilter`, as of `left_by`, where there is one.

    Raises
    ------
    ValueError : nothing of the run proper is recorded.
    """
    record, before = proper(records, RECORDING, made), proper(records, UNCOMPENSATED, made)
    if record is None:
        raise ValueError("nothing of the run proper is recorded")
    found: dict[str, Any] = {"seconds": len(record.data[made.timeline.proper]) / record.rate}
    live = made.config.session.live
    if not (live and made.config.deflection.on):  # what the stage compensates it keeps to itself
        found["position_error"] = _measures(record, made, "reference", "position")
    if not live or reads_laser(made.config):
        found["tool_error"] = _measures(record, made, wanted_name(made), "absolute")
    if before is not None:
        found["uncompensated_tool_error"] = _measures(before, made, wanted_name(made), "absolute")
        if "tool_error" in found:
            pairs = found["uncompensated_tool_error"], found["tool_error"]
            found["improvement"] = {axis: pairs[0][axis]["mae"] / pairs[1][axis]["mae"] for axis in pairs[1]}
    if made.prefilters:
        found["prefilter"] = left_by(made)
    return found


def proper(records: Mapping[str, Recording], name: str, made: Setup) -> Recording | None:
    """Return a recording of which there is something of the run proper, or None.

    Parameters
    ----------
    records : mapping of str to Recording
    name : str
    made : Setup
    """
    record = records.get(name)
    return record if record is not None and len(record.data) > made.timeline.begin else None


def left_by(made: Setup) -> dict[str, dict[str, float]]:
    """Return what each axis' loop leaves of the deflection that its prefilter is made for, `left` and `without` it."""
    pairs = zip(made.config.stage.axes, made.prefilters, strict=bool(made.prefilters))
    return {axis: {"left": each.left, "without": each.without} for axis, each in pairs if each is not None}


def wanted_name(made: Setup) -> str:
    """Return the signal that says where the tool is wanted: of a live run, what was sent to the stage.

    Parameters
    ----------
    made : Setup
    """
    return "reference" if made.config.session.live else "wanted"


def error_of(record: Recording, made: Setup, wanted: str, measured: str) -> np.ndarray:
    """Return the error over the run proper, shape (samples, axes), m: the channels `wanted` less those `measured`.

    Parameters
    ----------
    record : Recording
    made : Setup
    wanted, measured : str
    """
    axes = made.config.stage.axes
    parts = [record.select([f"{name}_{axis}" for axis in axes]).data for name in (wanted, measured)]
    error: np.ndarray = (parts[0] - parts[1])[made.timeline.proper]
    return error


def _measures(record: Recording, made: Setup, wanted: str, measured: str) -> dict[str, dict[str, float]]:
    error = error_of(record, made, wanted, measured)
    return {axis: asdict(tracking(column)) for axis, column in zip(made.config.stage.axes, error.T, strict=True)}
