"""What no control of the feed can do better where wood is harder at once: a lower bound of the largest force.

`python -m benchmarks.feed_bound [SEED ...] [--write]` mills slots in drawn cells whose far half is three times as hard.
"""

import sys
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.force_intervals import drawn
from benchmarks.page_table import put, table
from calibration.state_space.model import InnovationModel
from ctlblocks.recording import Recording
from rigkit.experiment.runner import Conduct
from rigkit.experiment.succession import run_in_memory
from stagectl.experiments.feed.job import Job, pocket_of
from stagectl.experiments.feed.pockets import Pockets
from stagectl.experiments.feed.process_run import channel
from stagectl.experiments.feed.read_back import velocity_model
from stagectl.robot.config import CellConfig

SEEDS = range(6110, 6116)
TIMES = 3.0
PARTS, SAMPLES = 40, 60
"""Of a sample; samples that are looked at."""
HALF_SLOT = 13.5
"""Cells from where the tool begins to the middle."""
BEFORE, ENTERED = (2e-3, 5e-4), 4e-3
"""m before the tool's tip reaches the hard half, over which feed and force are means; m in which it has entered."""


@dataclass(frozen=True)
class Entry:
    """A tool that goes into harder wood: feed (m/s) and force (N) before, stiffness (N/m) and radius (m)."""

    feed: float
    force: float
    stiffness: float
    radius: float


def slowest(model: InnovationModel, feed: float, least: float, most: float) -> np.ndarray:
    """Return the lowest velocity at each sample after a change is seen, whatever is asked of it within limits, m/s.

    Each sample is the least of its own: v_0 less all that any sequence of commands between `least` and `most` can take
    off by then.  The sensor shows the change at the end of the sample in which it began.
    """
    step = model.simulate(np.ones((SAMPLES, 1)))[:, 0]
    answer = np.diff(step, prepend=0.0)
    down, up = np.cumsum(np.maximum(answer, 0.0)), np.cumsum(np.maximum(-answer, 0.0))
    return np.concatenate([[feed], feed - (feed - least) * down - (most - feed) * up])


def bound(model: InnovationModel, entry: Entry, least: float, most: float) -> float:
    """Return the lower bound of the largest force over that before, 1.

    f' = K_f (v - kappa f), as (7.4) has it; kappa falls to a third by the part of the chips that is in the hard half:
    with the tip s beyond its edge, sqrt(1 - (1 - s / R)^2) of the area in front of a round tool.  A lower velocity is
    less depth and less force, so the lowest velocities give the lowest force.
    """
    speed, rate = slowest(model, entry.feed, least, most), model.rate
    times = np.arange(SAMPLES * PARTS) / (PARTS * rate)
    velocity = np.interp(times * rate, np.arange(len(speed)), speed)
    period, deep, force, largest = 1.0 / (PARTS * rate), 0.0, entry.force, 1.0
    for each in velocity:
        deep = min(max(deep + each * period, 0.0), entry.radius)
        share = np.sqrt(1.0 - (1.0 - deep / entry.radius) ** 2)
        kappa = entry.feed / entry.force / (1.0 + (TIMES - 1.0) * share)
        decay = entry.stiffness * kappa * period
        force += -np.expm1(-decay) * (each / kappa - force)
        largest = max(largest, force / entry.force)
    return float(largest)


def milled(cell: CellConfig, brake: float) -> Recording:
    """Mill a slot whose far half is harder; return its recording."""
    cuts = cell.feed_plants.model_copy(update={"cut_options": cell.feed_plants.cut_options | {"step": TIMES}})
    force = cell.force.model_copy(update={"brake": brake})
    cell = cell.model_copy(update={"feed_plants": cuts, "force": force})
    job = replace(Job("slot"), pocket=pocket_of("slot", cell.segments))
    return run_in_memory(Pockets(cell, job, velocity_model(None)).parts(), Conduct())[1]["force-1"]


def row(seed: int) -> list[object]:
    """Return a line of the table; the edge is in the middle of the slot, a radius before it the tip is there."""
    cell, family = drawn(seed)
    task, told = cell.segments, []
    radius, most = 1.5 * task.cell, cell.force.highest
    for brake in (100.0, cell.force.brake):
        record = milled(cell, brake)
        place, force = channel(record, "tool_x"), channel(record, "resultant")
        runs = np.flatnonzero(channel(record, "is_running") > 0.5)
        middle = place[runs[0]] + HALF_SLOT * task.cell
        tip = place[runs] - (middle - radius)
        before, entering = runs[(tip > -BEFORE[0]) & (tip < -BEFORE[1])], runs[(tip > -BEFORE[1]) & (tip < ENTERED)]
        if len(before) == 0 or len(entering) == 0:
            return [seed, family, *["never there"] * 5]
        entry = Entry(float(channel(record, "estimated")[before].mean()), float(force[before].mean()),
                      cell.force.stiffness, radius)  # fmt: skip
        least = bound(velocity_model(None), entry, -cell.force.retreat, most)
        largest = force[entering].max() / entry.force
        told.append((1e3 * entry.feed, least, largest))
    feed, least, largest = told[1]
    return [
        seed,
        family,
        f"{feed:.1f}",
        f"{least:.2f}",
        f"{largest:.2f}",
        f"{largest / least:.2f}",
        f"{told[0][2]:.2f}",
    ]


def main() -> None:
    """Print a line a cell."""
    rows = []
    for seed in [int(each) for each in sys.argv[1:] if each.isdigit()] or SEEDS:
        rows.append(row(seed))
        print(rows[-1], flush=True)
    head = ["cell", "cut", "feed before, mm/s", "bound", "largest on entering", "over the bound", "without the brake"]
    put(table(head, rows), "validation/force.md", "bound")


if __name__ == "__main__":
    main()
