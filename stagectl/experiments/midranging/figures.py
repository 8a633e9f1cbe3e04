"""What a mid-ranging run comes to: of each axis, and of all together."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ctlblocks.recording import Recording
from stagectl.experiments.midranging.measures import figures, together
from stagectl.experiments.midranging.scenario import RADIUS, TOROID, Scenario
from stagectl.robot.midranging_config import MidrangeConfig

BOTH = 2
"""Axes of the toroid."""


def all_figures(
    runs: Mapping[str, Recording], chosen: Mapping[str, Scenario], config: MidrangeConfig
) -> dict[str, Any]:
    """Return what a run comes to: the figures of its one axis; or of each in `axes`, and of all together.

    Of all together `seconds`, and the sums and largest of what the axes have; of the toroid `circle` as well: mean
    absolute, standard and largest deviation from the path's circle, m.
    """
    if config.session.live:  # nothing was done to the pair that could be compared with
        chosen = {axis: replace(each, options={}) for axis, each in chosen.items()}
    each = {axis: figures(run, chosen[axis], config) for axis, run in runs.items()}
    if list(each) == [""]:
        return each[""]
    found: dict[str, Any] = {"seconds": next(iter(each.values()))["seconds"]}
    found["iae"] = sum(axis["iae"] for axis in each.values())
    for name in ("control_over_limit", "saturated_share", "fast_rms", "fast_peak"):
        found[name] = max(axis[name] for axis in each.values())
    taken = [axis["taken_over_at"] for axis in each.values() if axis.get("taken_over_at") is not None]
    if any("taken_over_at" in axis for axis in each.values()):
        found["taken_over_at"] = min(taken, default=None)
    if len(runs) == BOTH and all(scenario.name == TOROID for scenario in chosen.values()):
        off = circle_deviation(runs)
        found["circle"] = {
            "mean_absolute": float(np.abs(off).mean()),
            "std": float(off.std()),
            "largest": float(np.abs(off).max()),
        }
    return found | {"axes": each}


def circle_deviation(runs: Mapping[str, Recording]) -> np.ndarray:
    """Return how far outside the toroid's circle the relative position is, shape (samples,), m."""
    x, y = together(runs, "position")
    return np.asarray(np.hypot(x, y - RADIUS) - RADIUS)
