"""The toroid as an experiment: a part for each setup, simulated or as it was recorded."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from ctlblocks.recording import Recording
from ctlblocks.room import bytes_of
from rigkit.experiment.kind import Records
from rigkit.experiment.part import Part, Phase, Retreat
from stagectl.devices.signals import AXES
from stagectl.experiments.toroid.figures import figures
from stagectl.experiments.toroid.graph import CellGraph
from stagectl.experiments.toroid.makes import Make, recorded, simulated
from stagectl.experiments.toroid.plan import RATE, Plan
from stagectl.experiments.toroid.report import write_report
from stagectl.link.tell import Tell, nobody
from stagectl.stage.loop_parameters import loop_parameters
from stagectl.trials.conduct import AFTERWARDS


class Toroid:
    """Setups of the cell, one after another; one that is held does not keep the next from being run.

    Parameters
    ----------
    plans : sequence of Plan
        One at least.
    reasons : mapping of str to str, optional
        Why setups were held, of those that have been run.
    """

    def __init__(self, plans: Sequence[Plan], reasons: Mapping[str, str] | None = None) -> None:
        self.plans, self.reasons = tuple(plans), dict(reasons or {})

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
        numbers = loop_parameters(AXES, loops) if loops else {}
        return {
            "setups": [plan.setup for plan in self.plans],
            "loops": {name: each.tolist() for name, each in numbers.items()},
        }

    @property
    def room(self) -> int:
        """Bytes that the recordings may take."""
        found = 0
        for plan in self.plans:
            cell = CellGraph(plan, nobody, simulated)
            for track in cell.tracks():
                rows = round(plan.path.seconds * RATE / track.every)
                found += bytes_of(rows, len(track.names(cell.graph)), "float64", "wav")
        return found

    def parts(self, tell: Tell = nobody) -> Iterator[Part]:
        """Give a part for each setup, simulated."""
        return (_part(plan, tell, simulated) for plan in self.plans)

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
            if f"{plan.setup}-surface" in records
        ]
        if not found:
            raise ValueError("nothing is recorded")
        return {"setups": found}

    def report(self, path: Path, records: Records, figures: Mapping[str, Any], png: Path | None) -> None:
        """Write the report."""
        found = [(plan, records_of(plan.setup, records)) for plan in self.plans if f"{plan.setup}-surface" in records]
        write_report(path, found, figures["setups"], png)


def records_of(setup: str, records: Records) -> dict[str, Recording]:
    """Return the recordings of one setup, by what they are of: cell, tracker, surface, stage."""
    return {
        name.removeprefix(f"{setup}-"): record for name, record in records.items() if name.rpartition("-")[0] == setup
    }


def _part(plan: Plan, tell: Tell, make: Make) -> Part:
    cell = CellGraph(plan, tell, make)
    total = round(plan.path.seconds * RATE)
    starts = {round(plan.cell.toroid.lead * RATE): cell.follow}
    if plan.has_stage:
        starts[round(plan.stage.limits.ramp * RATE) + 2] = cell.stage.start
    edges = sorted(starts)
    phases = [Phase("rest", edges[0])] if edges[0] else []
    for first, last in zip(edges, [*edges[1:], total], strict=True):
        phases.append(Phase(starts[first].__name__, last - first, starts[first]))
    retreat = Retreat(cell.fault, cell.port.hold, round((plan.cell.limits.stop + AFTERWARDS) * RATE))
    tracks = tuple(cell.tracks())
    return Part(plan.setup, cell.graph, tracks, phases, None, retreat, cell.figures, is_apart=True)
