"""The robot's velocity model from steps of the feed behind its wires, beside the same steps in process.

Guards against steps that work in process alone, and against a robot that goes on when it is at fault.
"""

from typing import Any

import numpy as np
import pytest

from calibration.milling.velocity import identify_velocity
from ctlblocks import Graph
from rigkit.experiment.runner import Conduct, remembered
from stagectl.experiments.feed.free_run import FreeRun
from stagectl.experiments.feed.job import RATES
from stagectl.experiments.feed.plan import feed_plan
from stagectl.link.tell import nobody
from stagectl.planning.problem import Pocket
from stagectl.robot.live.led import LedRobot
from stagectl.robot.live.person import Person
from stagectl.robot.milling.nominal_velocity import nominal_velocity
from tests.scenario.stepped_cell import SteppedCell

pytestmark = pytest.mark.stall(0.3)

SETTINGS: dict[str, Any] = {"robot": {"travel": 0.25}, "limits": {"speed": 1.0}, "force_sensor": {"port": 1}}
"""A robot that hurries to its work, without a force sensor."""
SECONDS = 6.0


def free_of(cell: SteppedCell) -> FreeRun:
    plan = feed_plan(cell.config, Pocket(30, 30, 3, "EW", RATES, v_lift=50.0), nominal_velocity(250.0))
    return FreeRun(plan, "x", SECONDS, 1)


def robot_of(cell: SteppedCell) -> LedRobot:
    return LedRobot(cell.config, Person(lambda _: None, False), cell.now)


@pytest.mark.slow
def test_the_robot_answers_as_in_process_but_for_a_report() -> None:
    with SteppedCell(**SETTINGS) as cell:
        free = free_of(cell)
        with free.wired(robot_of(cell), nobody, Conduct().stopped) as part:
            records, ended = remembered(part, Conduct())
    assert ended.reason == ""
    live = free.velocities(records[free.name])
    with free.simulated() as part:
        inside = free.velocities(remembered(part, Conduct())[0][free.name])
    assert live.data[:, 0].tobytes() == inside.data[:, 0].tobytes()
    true, apart = inside.data[3:-3, 1], []
    for early in range(-1, 4):  # reports: on a busy machine some come together, and are answered once
        apart.append(np.std(live.data[3 - early : len(live.data) - 3 - early, 1] - true))
    assert min(apart) < 0.15 * np.std(true)
    assert identify_velocity(live).fresh.free_run.nrmse[0] > 85.0


def test_a_fault_of_the_robot_ends_it_by_its_name() -> None:
    with SteppedCell(**SETTINGS) as cell:
        free = free_of(cell)

        def look(graph: Graph) -> None:
            if graph.ticks == 2_000:
                cell.mishaps.append(lambda: cell.bench.suffer("trip"))

        with free.wired(robot_of(cell), nobody, Conduct().stopped) as part:
            _, ended = remembered(part, Conduct(look=look))
    assert "motors are off" in ended.reason
