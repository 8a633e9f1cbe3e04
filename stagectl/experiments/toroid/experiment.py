"""The toroid as an experiment: a part for each setup, simulated or as it was recorded."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from ctlblocks.recording import Recording
from ctlblocks.room import bytes_of
from rigkit.experiment.kind import Records
from rigkit.experiment.part import Part, Phase, Retreat
from rigkit.experiment.runner import never
from rigkit.priority import real_time
from stagectl.devices.signals import AXES
from stagectl.experiments.toroid.figures import figures
from stagectl.experiments.toroid.graph import CellGraph
from stagectl.experiments.toroid.makes import Make, recorded, simulated
from stagectl.experiments.toroid.plan import Plan
from stagectl.experiments.toroid.report import write_report
from stagectl.experiments.toroid.wired import Ends, bring, opened, refuse_unfit, wired
from stagectl.link.tell import Tell, nobody
from stagectl.robot.live.clock import ReportClock
from stagectl.robot.wired_port import AFTERWARDS
from stagectl.stage.loop_parameters import loops_as_json

Confirm = Callable[[str, Callable[[], bool]], object]
"""Returns once a person has confirmed what comes, or raises `Stopped`."""


def unasked(what: str, stopped: Callable[[], bool]) -> None:
    """Ask nobody."""


class Toroid:
    """Setups of the cell, one after another; one that is held does not keep the next from being run.

    Parameters
    ----------
    plans : sequence of Plan
        One at least.
    reasons : mapping of str to str, optional
        Why setups were held, of those that have been run.
    confirm : callable(what, stopped)
        Has a person beside a live robot confirm each setup.
    now : callable() -> float, s, a monotonic clock

    Raises
    ------
    ValueError : live, a stage that does not fit its wire.

    Attributes
    ----------
    ends : Ends or None
        The wires while they are open.
    """

    def __init__(
        self,
        plans: Sequence[Plan],
        reasons: Mapping[str, str] | None = None,
        confirm: Confirm = unasked,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self.plans, self.reasons = tuple(plans), dict(reasons or {})
        self._confirm, self._now = confirm, now
        self.ends: Ends | None = None
        for each in self.plans:
            if each.is_live:
                refuse_unfit(each)

    @property
    def seconds(self) -> float:
        """Of all setups."""
        return sum(plan.path.seconds for plan in self.plans)

    @property
    def about(self) -> dict[str, str]:
        """Provenance of the recordings."""
        return {"rig": self.plans[0].stage.rig.name}

    @property
    def designed(self) -> dict[str, Any]:
        """The setups, and the numbers of the stage's loops."""
        loops = next((plan.loops for plan in self.plans if plan.loops), ())
        return {
            "setups": [plan.setup for plan in self.plans],
            "live": self.is_live,
            "loops": loops_as_json(AXES, loops) if loops else {},
        }

    @property
    def is_live(self) -> bool:
        """Whether robot, tracker and stage are behind their wires."""
        return self.plans[0].is_live

    @property
    def room(self) -> int:
        """Bytes that the recordings may take: live no more than simulated without a stage, where the cut is known."""
        found = 0
        for plan in (replace(each, setup="B", is_live=False) if each.is_live else each for each in self.plans):
            cell = CellGraph(plan, nobody, simulated)
            for track in cell.tracks():
                rows = round(plan.path.seconds * plan.pace.rate / track.every)
                found += bytes_of(rows, len(track.names(cell.graph)), "float64", "wav")
        return found

    def parts(self, tell: Tell = nobody, stopped: Callable[[], bool] = never) -> Iterator[Part]:
        """Give a part for each setup, simulated or, after it was confirmed and the path's beginning reached, live.

        Raises
        ------
        ValueError : live, the robot is not near the path.
        LinkError, Stopped : a wire that cannot be had; it is to stop.
        """
        for plan in self.plans:
            if plan.is_live:
                yield from self._live(plan, tell, stopped)
            else:
                yield _part(plan, tell, simulated)

    def _live(self, plan: Plan, tell: Tell, stopped: Callable[[], bool]) -> Iterator[Part]:
        held = "the workpiece on the robot, the tool clear of it where the path begins, nobody in the cell"
        self._confirm(f"setup {plan.setup}, {plan.path.seconds:.0f} s: {held}", stopped)
        bring(plan, tell, stopped, self._now)
        with opened(plan, tell, self._now) as ends, real_time():
            made = _part(plan, ends.wires.unless_told(tell), wired(ends))
            made.graph.rehearse()  # the robot is not led yet, nor the stage
            assert made.retreat is not None
            retreat = replace(made.retreat, fault=partial(ends.fault, made.retreat))
            self.ends = ends
            try:
                yield replace(made, clock=ReportClock(ends.wires, plan.pace.slow), retreat=retreat, rest=ends.rest)
            finally:
                self.ends = None

    def again(self, records: Records) -> Iterator[Part]:
        """Give a part for each setup that is recorded, its sensors as they were."""
        return (
            _part(plan, nobody, recorded(records_of(plan.setup, records)))
            for plan in self.plans
            if f"{plan.setup}-cell" in records
        )

    def figures(self, records: Records) -> dict[str, Any]:
        """Return the figures of each setup that is recorded."""
        found = [
            figures(plan, records_of(plan.setup, records), self.reasons.get(plan.setup, ""))
            for plan in self.plans
            if f"{plan.setup}-cell" in records
        ]
        if not found:
            raise ValueError("nothing is recorded")
        return {"setups": found}

    def report(self, path: Path, records: Records, figures: Mapping[str, Any], png: Path | None) -> None:
        """Write the report."""
        found = [(plan, records_of(plan.setup, records)) for plan in self.plans if f"{plan.setup}-cell" in records]
        write_report(path, found, figures["setups"], png)


def records_of(setup: str, records: Records) -> dict[str, Recording]:
    """Return the recordings of one setup, by what they are of: cell, tracker, surface, stage."""
    return {
        name.removeprefix(f"{setup}-"): record for name, record in records.items() if name.rpartition("-")[0] == setup
    }


def _part(plan: Plan, tell: Tell, make: Make) -> Part:
    cell = CellGraph(plan, tell, make)
    rate = plan.pace.rate
    total = round(plan.path.seconds * rate)
    starts = {round(plan.cell.toroid.lead * rate): cell.follow}
    if cell.stage is not None:
        starts[round(plan.stage.limits.ramp * rate) + 2] = cell.stage.start
    edges = sorted(starts)
    phases = [Phase("rest", edges[0])] if edges[0] else []
    for first, last in zip(edges, [*edges[1:], total], strict=True):
        phases.append(Phase(starts[first].__name__, last - first, starts[first]))
    retreat = Retreat(cell.fault, cell.port.hold, round((plan.cell.limits.stop + AFTERWARDS) * rate))
    tracks = tuple(cell.tracks())
    return Part(plan.setup, cell.graph, tracks, phases, None, retreat, cell.figures, is_apart=True)
