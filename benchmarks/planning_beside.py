"""How long a tick of a paced, simulated pocket of 30 x 30 cells takes at most, with the planner in it and beside it.

    python -m benchmarks.planning_beside [--seconds 10] [--write]

Four directions, thirds.  A tick is from its beginning to that of the next one, with what is done between them and
without the sleep.  For each planner median and longest of the ticks after which a strip was chosen, with the planner in
the tick (`patience` None) and beside it; and the longest of all others, which the computer is to blame for.
The program has the priority that it has on a live robot, where that is granted.
"""

import argparse
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from benchmarks.page_table import FLAG, put, table
from ctlblocks import Graph
from ctlblocks.clock import Offline
from rigkit import config as rig_file
from rigkit.experiment.runner import Conduct, remembered
from rigkit.priority import undisturbed
from stagectl.experiments.feed.feed_graph import FeedGraph
from stagectl.experiments.feed.job import RATES, pocket_of
from stagectl.experiments.feed.plan import RATE, feed_plan
from stagectl.experiments.feed.pocket_part import pocket_part
from stagectl.experiments.feed.surroundings import simulated
from stagectl.link.tell import nobody
from stagectl.planning.beside import PATIENCE, PlannerBeside
from stagectl.planning.milling import Milled, Planner
from stagectl.planning.pocket import planner
from stagectl.planning.problem import Pocket
from stagectl.planning.strips import Cut, Standing
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.nominal_velocity import nominal_velocity

NAMES = ("sequential", "qlearning", "exact", "features", "uncertain")
QUICK = ("segments.travel=0.2", "segments.plunge=0.1", "feed_plants.cut_options.knots=0", "force.force=25")
"""Settings with which strips follow each other sooner."""


class _Marked:
    """Marks when a strip was chosen while the tool moves."""

    def __init__(self, within: Planner) -> None:
        self._within, self.chosen = within, 0

    def choose(self, standing: Standing) -> Cut:
        self.chosen += 1
        return self._within.choose(standing)

    def learn(self, milled: Milled) -> None:
        self._within.learn(milled)


class _Watched(Offline):
    """In real time; keeps how long ticks took, apart by whether a strip was chosen after them."""

    def __init__(self, marked: _Marked, now: Callable[[], float] = time.perf_counter) -> None:
        self._marked, self._now, self._start, self._last, self._seen = marked, now, 0.0, 0.0, 1
        self.choosing, self.others = [0.0], [0.0]

    def advance(self, graph: Graph, ticks: int) -> None:
        """Tick, and sleep until the next one is due."""
        for _ in range(ticks):
            now = self._now()
            if graph.ticks:
                is_choice = self._marked.chosen != self._seen
                (self.choosing if is_choice else self.others).append(now - self._last)
                self._seen = self._marked.chosen
            else:
                self._start = now
            ahead = self._start + graph.ticks / graph.rate - now
            if ahead > 0.0:
                time.sleep(ahead)
            self._last = self._now()
            graph.tick()


def _pocket(cell: CellConfig) -> Pocket:
    pocket = pocket_of("pocket", cell.segments)
    assert pocket is not None
    more = {f"{feed}{name[1:]}": rate for name, rate in RATES.items() for feed in ("N" if name[0] == "E" else "S")}
    return replace(pocket, feeds="EWNS", rate={**RATES, **more})


def ticks(name: str, seconds: float, patience: float | None) -> tuple[list[float], dict[str, int]]:
    """Return median and longest tick with a choice and the longest of the others, s, and how choices came about."""
    cell = rig_file.load(None, CellConfig, QUICK)
    pocket = _pocket(cell)
    plan = feed_plan(cell, pocket, nominal_velocity(250.0))
    with undisturbed(), PlannerBeside(planner(name, pocket), pocket, nobody, patience) as beside:
        marked = _Marked(beside)
        part = pocket_part(FeedGraph(plan, lambda: marked, nobody, simulated))
        clock = _Watched(marked)
        remembered(part, Conduct(lambda: part.graph.ticks > seconds * RATE, clock))
    choices = clock.choosing[1:] or [float("nan")]
    counts = {"choices": len(clock.choosing) - 1, **beside.counts()}
    return [float(np.median(choices)), max(choices), max(clock.others)], counts


def main() -> None:
    """Measure, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument(FLAG, action="store_true")
    chosen = parser.parse_args()
    rows = []
    ticks(NAMES[0], 1.0, None)  # what is compiled is compiled
    for name in NAMES:
        for where, patience in (("in the tick", None), ("beside it", PATIENCE)):
            times, counts = ticks(name, chosen.seconds, patience)
            each = [counts[key] for key in ("choices", "planned_ahead", "planned_late")]
            rows.append([f"`{name}`", where, *(f"{1e3 * time:.1f}" for time in times), *each])
    head = ["planner", "planned", "median, ms", "longest, ms", "longest other tick, ms", "choices", "ahead", "late"]
    put(table(head, rows), "planning.md", "beside")


if __name__ == "__main__":
    main()
