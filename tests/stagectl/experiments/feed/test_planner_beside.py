"""Choices beside the tick, in a run: what was chosen is replayed bit for bit, however it came to be chosen.

Guards against a planner that holds the robot's tick up, and a replay in which the planner is in time.
"""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from threading import Event

import pytest

from rigkit.experiment.again import replayed
from rigkit.experiment.kept import create, run
from rigkit.experiment.runner import STOPPED, Conduct
from stagectl.experiments.feed.bench import SimulatedBench
from stagectl.experiments.feed.job import Job
from stagectl.experiments.feed.pockets import Pockets
from stagectl.experiments.feed.read_back import FORCE, Files
from stagectl.planning.milling import Milled, Planner
from stagectl.planning.pocket import planner
from stagectl.planning.problem import Pocket
from stagectl.planning.strips import Cut, Standing
from tests.stagectl.experiments.feed.small_pocket import small


@pytest.fixture
def go() -> Iterator[Event]:
    """Let every late planner go at the end."""
    event = Event()
    yield event
    event.set()


class _Late:
    """Chooses the first strip, and no other until it is let go."""

    def __init__(self, pocket: Pocket, go: Event) -> None:
        self._within, self._go, self._has_begun = planner("exact", pocket), go, False

    def choose(self, standing: Standing) -> Cut:
        if self._has_begun:
            self._go.wait()
        self._has_begun = True
        return self._within.choose(standing)

    def learn(self, milled: Milled) -> None:
        """Learn nothing."""


@dataclass(frozen=True)
class _Job(Job):
    """A job whose planner there is already."""

    made: Planner | None = None

    def make(self) -> Planner:
        assert self.made is not None
        return self.made


def _milled(path: Path, go: Event, asked: float = 1e9) -> dict[str, str]:
    """Mill a pocket of three strips with a late planner that nobody waits for, or stop after so many questions."""
    plan, seen = small(rows=9), [0.0]

    def stopped() -> bool:
        seen[0] += 1.0
        return seen[0] > asked

    job = _Job("pocket", plan.pocket, made=_Late(plan.pocket, go))
    made = Pockets(plan.cell, job, plan.model, SimulatedBench(is_paced=True))
    files = Files(Job("pocket", plan.pocket, "exact"), None)
    with create(path, FORCE, plan.cell, made, files.take_into) as folder:
        reasons, _ = run(folder, FORCE, made, Conduct(stopped, after=lambda _: go.set()))
    return reasons


def _events(path: Path, name: str) -> list[dict[str, object]]:
    found = [json.loads(line) for line in (path / "events.jsonl").read_text().splitlines()]
    return [each for each in found if each["event"] == name]


def test_a_late_planner_s_pocket_is_milled_in_the_default_order_and_replayed(tmp_path: Path, go: Event) -> None:
    path = tmp_path / "run"
    assert _milled(path, go) == {}
    late = _events(path, "planner")
    assert late[0]["segment"] == 2
    assert {each["reason"] for each in late} == {"late"}
    (ended,) = _events(path, "ended")
    assert ended["planned_late"] == len(late)
    again = list(replayed(path, FORCE))
    assert {"number", "cut_1", "cut_2"} <= {each.channel for each in again}
    assert all(each.identical for each in again)


def test_a_stop_while_the_planner_is_at_work_ends_the_run_and_is_replayed(tmp_path: Path, go: Event) -> None:
    path = tmp_path / "run"
    assert _milled(path, go, asked=60) == {"force-1": STOPPED}
    assert all(each.identical for each in replayed(path, FORCE))
