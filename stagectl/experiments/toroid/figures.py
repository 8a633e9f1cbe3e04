"""What a setup of the toroid comes to, from its recordings alone."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from ctlblocks.recording import Recording
from stagectl.devices.signals import AXES
from stagectl.experiments.toroid.measures import Contour, accuracy, contour
from stagectl.experiments.toroid.plan import SETUPS, TOUCH_OFF, Plan
from stagectl.experiments.toroid.turned import turned

BEFORE = 0.25
"""s before a hold that are not measured: a stage that is at fault goes to rest while the robot still moves."""


def figures(made: Plan, records: Mapping[str, Recording], reason: str) -> dict[str, Any]:
    """Return what a run comes to, other programs' keys.

    Parameters
    ----------
    made : Plan
    records : mapping of str to Recording
        `cell`, `tracker` and `surface`.
    reason : str

    Returns
    -------
    dict
        `setup`, `what`, `seconds`, `fault` (or null); where something was milled `circle_mae`, `circle_std`,
        `circle_max`, `surface_std`, `roughness` (m); `turned`, by how much the workpiece was seen to turn (rad, rms);
        `seen`, the same as of what was milled, but for roughness, of what `deviation` says, where the tool was
        followed; with a stage, by axis, `travel` (lowest and highest reference wished for, m, from the middle),
        `travel_limit` (m) and `seconds_at_end` (s).
    """
    found: dict[str, Any] = {
        "setup": made.setup,
        "what": SETUPS[made.setup],
        "seconds": len(records["cell"].data) / records["cell"].rate,
        "fault": reason or None,
    }
    milled = milled_contour(made, records)
    if milled is not None:
        found |= asdict(accuracy(milled))
    if (turn := _turned(made, records)) is not None:
        found["turned"] = turn
    if (seen := seen_deviation(made, records)) is not None:
        radial, axial = np.abs(seen[:, 1]), seen[:, 2]
        spread = {"circle_std": float(seen[:, 1].std()), "surface_std": float(axial.std())}
        found["seen"] = {"circle_mae": float(radial.mean()), "circle_max": float(radial.max()), **spread}
    if made.has_stage:
        wished = records["cell"].select([f"fast_reference_{axis}" for axis in AXES])
        low, high = made.stage.limits.travel
        limit = (high - low) / 2
        found["travel"] = {axis: [float(w.min()), float(w.max())] for axis, w in zip(AXES, wished.data.T, strict=True)}
        found["travel_limit"] = limit
        found["seconds_at_end"] = float((abs(wished.data) > limit).any(axis=1).sum() / wished.rate)
    return found


def milled_contour(made: Plan, records: Mapping[str, Recording]) -> Contour | None:
    """Return the toroid as it was milled, until just before a hold, or None where nothing was.

    Parameters
    ----------
    made : Plan
    records : mapping of str to Recording
        `cell` and `surface`.
    """
    if "surface" not in records:  # behind wires nobody knows what was cut
        return None
    surface, cell = records["surface"], records["cell"]
    begin, end = _milling(made, cell)
    cut = surface.select([f"cut_{axis}" for axis in AXES]).data[round(begin * surface.rate) : round(end * surface.rate)]
    try:
        return contour(cut, made.cell.toroid.radius)
    except (ValueError, IndexError):
        return None


def seen_deviation(made: Plan, records: Mapping[str, Recording]) -> np.ndarray | None:
    """Return how far off its path the tool was seen, until just before a hold, or None where it was not followed.

    By the tracker, with a stage by its sensors as well: as noisy, and as late, as those are.

    Parameters
    ----------
    made : Plan
    records : mapping of str to Recording
        `cell`.

    Returns
    -------
    array, shape (samples, 3), or None
        Time in s, outwards and along the tool's axis in m.
    """
    cell = records["cell"]
    begin, end = (round(time * cell.rate) for time in _milling(made, cell))
    off = cell.select([f"deviation_{axis}" for axis in AXES]).data[begin:end]
    if len(off) < cell.rate / 2 or not off.any():
        return None
    time = np.arange(begin, begin + len(off)) / cell.rate
    _, y, z = made.path.wanted(time - made.cell.feedback.lag).T
    outwards = (off[:, 1] * y + off[:, 2] * z) / np.hypot(y, z)
    return np.column_stack([time, outwards, off[:, 0]])


def _turned(made: Plan, records: Mapping[str, Recording]) -> float | None:
    tracker, touched = records["tracker"], (TOUCH_OFF[0], made.cell.toroid.lead - TOUCH_OFF[1])
    orientation = tracker.select([f"workpiece_{number}" for number in range(4, 8)]).data
    turn = turned(orientation, tracker.rate, touched, _milling(made, records["cell"]))
    return turn if np.isfinite(turn) else None


def _milling(made: Plan, cell: Recording) -> tuple[float, float]:
    """Return from when to when the tool mills, s; until just before a hold."""
    lead, end = made.cell.toroid.lead, len(cell.data) / cell.rate
    held = np.flatnonzero(cell.select(["holding"]).data[round(lead * cell.rate) + 2 :, 0])
    return lead, lead + held[0] / cell.rate - BEFORE if len(held) else end
