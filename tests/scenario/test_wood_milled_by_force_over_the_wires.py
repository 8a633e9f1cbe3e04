"""A strip of oak milled on the robot behind its wires: the force is held, replayed bit for bit, and faults end safely.

Guards against force control that works in process alone, and against a tool that stays pressed into the wood when the
sensor, the robot or its user has had enough.
"""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pytest

from firmware_sim.robot_cell import cell_wood
from rigkit.experiment.runner import STOPPED, Conduct, remembered, repeated
from stagectl.experiments.feed.feed_graph import FeedGraph
from stagectl.experiments.feed.job import RATES
from stagectl.experiments.feed.measures import retold
from stagectl.experiments.feed.plan import FeedPlan, feed_plan
from stagectl.experiments.feed.pocket_part import pocket_part
from stagectl.experiments.feed.pocketed import Pocketed
from stagectl.experiments.feed.process_run import channel
from stagectl.experiments.feed.recorded import SLOW
from stagectl.experiments.feed.surroundings import recorded
from stagectl.experiments.feed.wired import WiredBench
from stagectl.link.tell import Tell, nobody
from stagectl.planning.pocket import planner
from stagectl.planning.problem import Pocket
from stagectl.robot.live.person import Person
from stagectl.robot.milling.feed_force import PHASES
from stagectl.robot.milling.nominal_velocity import nominal_velocity
from tests.scenario.stepped_cell import SteppedCell

pytestmark = pytest.mark.stall(0.3)

SETTINGS: dict[str, Any] = {
    "segments": {"travel": 0.2, "plunge": 0.1, "stationary": 0.2, "slowest": 0.1},
    "feed_plants": {"cut_options": {"knots": 0}},
    "robot": {"travel": 0.25, "changer": True},
    "limits": {"speed": 1.0},
}
"""A robot that hurries to its work."""


@pytest.fixture
def cell() -> Iterator[SteppedCell]:
    with SteppedCell(cell_wood, **SETTINGS) as stepped:
        yield stepped


def plan_of(cell: SteppedCell) -> FeedPlan:
    return feed_plan(cell.config, Pocket(3, 13, 3, "EW", RATES, v_lift=50.0), nominal_velocity(250.0))


def milled(cell: SteppedCell, conduct: Conduct, tell: Tell = nobody) -> Pocketed:
    plan = plan_of(cell)
    bench = WiredBench(cell.config, Person(lambda _: None, False), cell.now)
    with bench.part(plan, planner("exact", plan.pocket), tell, conduct.stopped) as part:
        records, ended = remembered(part, conduct)
    record = records[plan.name]
    return Pocketed(record, retold(record, plan.pocket), ended.reason)


class Watch:
    """Looks at what the live run's graph has come to, and lets something happen once the force is controlled."""

    def __init__(self, cell: SteppedCell, mishap: str) -> None:
        self.cell, self.mishap, self.events = cell, mishap, list[str]()
        self._felt = 0

    def stopped(self) -> bool:
        """Look, as the run does now and then."""
        force = float(np.linalg.norm(self.cell.bench.controller.wrench[0, :2]))
        self._felt += force > 8.0
        if self._felt == 10 and self.mishap != STOPPED:
            self.cell.mishaps.append(lambda: self.cell.bench.suffer(self.mishap))
        return self._felt >= 10 and self.mishap == STOPPED

    def tell(self, event: str, fields: Mapping[str, Any]) -> None:
        """Keep what is told."""
        self.events.append(f"{event}: {fields['reason']}")


@pytest.mark.slow
def test_the_force_is_held_over_the_wires_and_replayed_bit_for_bit(cell: SteppedCell) -> None:
    done = milled(cell, Conduct())
    assert done.reason == ""
    assert sum(each.cut.k for each in done.segments) == 3
    record, plan = done.recording, plan_of(cell)
    controlled = channel(record, "phase") == PHASES.index("controlling")
    late = controlled & np.roll(controlled, 100)
    assert channel(record, "resultant")[late].mean() == pytest.approx(10.0, abs=0.5)
    part = pocket_part(FeedGraph(plan, lambda: planner("exact", plan.pocket), nobody, recorded(record)))
    again = repeated(part, SLOW * len(record.data))[plan.name]
    for name in part.tracks[0].made_names(part.graph):
        assert channel(again, name).tobytes() == channel(record, name).tobytes(), name


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mishap", "reason"),
    [
        ("force-saturate", "the force sensor is saturated: for 0.02"),
        (STOPPED, STOPPED),
        ("trip", "the robot's motors are off"),
    ],
)
def test_whatever_goes_wrong_takes_the_tool_back_or_holds_the_robot(
    cell: SteppedCell, mishap: str, reason: str
) -> None:
    watch = Watch(cell, mishap)
    done = milled(cell, Conduct(watch.stopped), watch.tell)
    assert done.reason.startswith(reason)
    assert len(watch.events) == 1
    record = done.recording
    place = np.column_stack([channel(record, f"place_{axis}") for axis in "xy"])
    begun = int(np.argmax(channel(record, "is_running") > 0.5))
    along = np.linalg.norm(place[begun:] - place[begun], axis=1)
    back = along.max() - along[-1]
    if mishap != "trip":
        assert back == pytest.approx(plan_of(cell).cell.force.distance, rel=0.3)
        assert np.linalg.norm(cell.bench.controller.wrench[0, :2]) < 1.0
    asked = channel(record, "reference_1")[-20:]
    assert np.ptp(asked) < 1e-9
