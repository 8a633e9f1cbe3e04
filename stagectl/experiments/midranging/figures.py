"""A run of one axis or several: each simulated by itself, or all together behind their wires; and what it comes to."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ctlblocks.clock import run_offline
from ctlblocks.recording import Recording
from stagectl.robot.config import CellConfig
from stagectl.robot.midranging.config import MidrangeConfig
from stagectl.robot.midranging.controllers import controller
from stagectl.robot.midranging.live import Look, run_live, unseen
from stagectl.robot.midranging.measures import figures, together
from stagectl.robot.midranging.scenario import RADIUS, TOROID, Scenario
from stagectl.robot.midranging.simulation import Advance, never, simulate

Runs = dict[str, Recording]
"""By the axis' name, which is empty where there is one axis only."""


def run_axes(
    name: str,
    cell: CellConfig,
    chosen: Mapping[str, Scenario],
    stopped: Callable[[], bool] = never,
    advance: Advance = run_offline,
    look: Look = unseen,
) -> Runs:
    """Run one controller on every axis.

    Parameters
    ----------
    name : str
        One of `CONTROLLERS`.
    cell : CellConfig
    chosen : mapping of str to Scenario
        By axis.
    stopped : callable() -> bool
        Whether to end early.
    advance : callable(Graph, int)
        Ticks what is simulated.
    look : callable(Graph, LivePair)
        Watches what is live, as of `run_live`.

    Raises
    ------
    ValueError : as of `simulate`; more axes than the stage has.
    Stopped : stopped before there was anything to record.
    LinkError : a live run that cannot begin, or ends by a fault.
    """
    config = cell.midranging
    if config.session.live:
        wanted = np.stack([each.reference for each in chosen.values()], axis=1)
        names = [axis or config.session.axis for axis in chosen]
        found = run_live(controller(name, config, len(chosen)), wanted, names, cell, stopped, look)
        return dict(zip(chosen, found, strict=True))
    return {
        axis: simulate(controller(name, config), each, _of_axis(config, number), stopped, advance)
        for number, (axis, each) in enumerate(chosen.items())
    }


def all_figures(runs: Runs, chosen: Mapping[str, Scenario], config: MidrangeConfig) -> dict[str, Any]:
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
    if all(scenario.name == TOROID for scenario in chosen.values()):
        off = circle_deviation(runs)
        found["circle"] = {
            "mean_absolute": float(np.abs(off).mean()),
            "std": float(off.std()),
            "largest": float(np.abs(off).max()),
        }
    return found | {"axes": each}


def circle_deviation(runs: Runs) -> np.ndarray:
    """Return how far outside the toroid's circle the relative position is, shape (samples,), m."""
    x, y = together(runs, "position")
    return np.asarray(np.hypot(x, y - RADIUS) - RADIUS)


def _of_axis(config: MidrangeConfig, number: int) -> MidrangeConfig:
    """Return the settings of an axis: another seed for each one, so that their noise is not the same."""
    if number == 0:
        return config
    options = {**config.simulator.options, "seed": config.simulator.options.get("seed", 1) + number}
    return config.model_copy(update={"simulator": config.simulator.model_copy(update={"options": options})})
