"""What a setup of the toroid comes to, from its recordings alone."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from ctlblocks.recording import Recording
from stagectl.devices.signals import AXES, QUICK
from stagectl.experiments.toroid.measures import Contour, accuracy, contour
from stagectl.experiments.toroid.plan import RATE, SETUPS, Plan

BEFORE = 0.25
"""s before a hold that are not measured: a stage that is at fault goes to rest while the robot still moves."""


def figures(made: Plan, records: Mapping[str, Recording], reason: str) -> dict[str, Any]:
    """Return what a run comes to, other programs' keys.

    Parameters
    ----------
    made : Plan
    records : mapping of str to Recording
        `cell` and `surface`.
    reason : str

    Returns
    -------
    dict
        `setup`, `what`, `seconds`, `fault` (or null); where something was milled `circle_mae`, `circle_std`,
        `circle_max`, `surface_std`, `roughness` (m); with a stage, by axis, `travel` (lowest and highest reference
        wished for, m, from the middle), `travel_limit` (m) and `seconds_at_end` (s).
    """
    found: dict[str, Any] = {
        "setup": made.setup,
        "what": SETUPS[made.setup],
        "seconds": len(records["surface"].data) * QUICK / RATE,
        "fault": reason or None,
    }
    milled = milled_contour(made, records)
    if milled is not None:
        found |= asdict(accuracy(milled))
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
    surface, cell = records["surface"], records["cell"]
    begin = round(made.cell.toroid.lead * surface.rate)
    held = np.flatnonzero(cell.select(["holding"]).data[round(made.cell.toroid.lead * cell.rate) + 2 :, 0])
    until = len(surface.data)
    if len(held):
        until = begin + round((held[0] / cell.rate - BEFORE) * surface.rate)
    cut = surface.select([f"cut_{axis}" for axis in AXES]).data[begin:until]
    try:
        return contour(cut, made.cell.toroid.radius)
    except (ValueError, IndexError):
        return None
