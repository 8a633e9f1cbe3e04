"""Trials of a milled path on the robot behind its wires: the same graph as simulated, bit for bit from what was heard.

Guards against trials that work in process alone, against recordings that a replay, a report or `--from` cannot use, and
against faults after which the tool stays in the material or nobody knows why.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.milling.session import calibrate
from calibration.milling.sweep_session import sweep
from calibration.raw_run import raw_run
from ctlblocks.recording import Recording
from firmware_sim.robot_cell import cell_cut
from rigkit.experiment.runner import STOPPED, Conduct, never, remembered, repeated
from stagectl.experiments.trials.campaign import carried_out, learn_free_space, learn_pocket
from stagectl.experiments.trials.done import DoneTrial
from stagectl.experiments.trials.laws import Learner
from stagectl.experiments.trials.log_folder import LogFolder, write_logs
from stagectl.experiments.trials.recorded import SLOW
from stagectl.experiments.trials.signals import tracker_late
from stagectl.experiments.trials.surroundings import recorded
from stagectl.experiments.trials.tool_path import RATE
from stagectl.experiments.trials.trial import Trial, first_trial
from stagectl.experiments.trials.trial_graph import TrialGraph
from stagectl.experiments.trials.wired import WiredBench
from stagectl.link.tell import Tell, nobody
from stagectl.robot.live.person import Person
from tests.scenario.stepped_cell import SteppedCell
from tests.stagectl.robot.milling.test_milling_models import models
from tests.until import until

pytestmark = pytest.mark.stall(0.3)

SETTINGS: dict[str, Any] = {
    "pocket": {
        "size": [11e-3, 11e-3], "depth": 5e-4, "clearance": 3e-4, "lead": 1.0, "tail": 0.5, "feed": 0.03,
        "workpiece": [20e-3, 20e-3, 2e-3], "slope": 0.3,
    },
    "robot": {"travel": 0.25, "changer": True},
    "limits": {"speed": 1.0},
    "tracker": {"blind": 0.5},
}  # fmt: skip
"""A small pocket, milled three times as fast as in a laboratory; robot and tool hurry to it."""
WHEN = 400
"""Samples after which something goes wrong: the tool is in the material."""


OVER_RSI = SETTINGS | {"robot": SETTINGS["robot"] | {"wire": "rsi", "commands": 0, "signals": 0}}
"""Its motors have a torque constant of 1 N m/A, as the simulator's have."""


@pytest.fixture
def cell(request: pytest.FixtureRequest) -> Iterator[SteppedCell]:
    with SteppedCell(cell_cut, **getattr(request, "param", SETTINGS)) as made:
        yield made


def height(cell: SteppedCell) -> float:
    """Return how far the tool's tip is over the block, m."""
    cut = cell.bench.controller._cut  # noqa: SLF001
    assert cut is not None
    return float(cell.bench.controller.plant.frames[7, 2, 3] - cut.origin[2])


class Laboratory:
    """Trials on a stepped cell, and what is told of them."""

    def __init__(self, cell: SteppedCell) -> None:
        self.cell, self.told, self.kept = cell, list[str](), list[DoneTrial]()
        self.bench = WiredBench(cell.config, Person(self.told.append, False), cell.now)
        self.first = first_trial(cell.config, "pocket")

    def run(self, name: str, trial: Trial) -> DoneTrial:
        records, reason = self.ran(name, trial, Conduct(), nobody)
        assert reason == ""
        self.kept.append(DoneTrial(name, trial, records))
        return self.kept[-1]

    def ran(self, name: str, trial: Trial, conduct: Conduct, tell: Tell) -> tuple[dict[str, Recording], str]:
        """Run a trial; return its recordings, by what they are of, and why it ended early."""
        with self.bench.part(name, trial, tell, conduct.stopped) as part:
            records, ended = remembered(part, conduct)
        return {track.removeprefix(f"{name}-"): record for track, record in records.items()}, ended.reason

    def spoiled(self, mishap: str, remedy: str) -> tuple[DoneTrial, str, list[str]]:
        """Mill until something happens; return what came of it, why it ended, and the events."""
        events, over = list[str](), list[bool]()

        def show(seconds: float) -> None:
            if seconds >= WHEN / RATE and not over:
                assert height(self.cell) < 0.0
                over.append(mishap == STOPPED)
                if mishap != STOPPED:
                    self.cell.mishaps.append(lambda: self.cell.bench.suffer(mishap))

        def tell(event: str, fields: Mapping[str, Any]) -> None:
            events.append(f"{event}: {fields['reason']}")

        milled = replace(self.first, is_milled=True)
        records, reason = self.ran("milled-0", milled, Conduct(lambda: any(over), show=show), tell)
        if remedy:
            self.cell.mishaps.append(lambda: self.cell.bench.suffer(remedy))
        return DoneTrial("milled-0", milled, records), reason, events


def refuse_another_replay(done: DoneTrial) -> None:
    """Put what was heard through the trial's graph again; all must come out as it was."""
    part = TrialGraph(done.name, done.trial, nobody, recorded(done.records)).part_again(done.left)
    again = repeated(part, SLOW * len(done.records["trial"].data))
    for track in part.tracks:
        names = track.made_names(part.graph)
        before = done.records[track.name.removeprefix(f"{done.name}-")].select(names)
        assert again[track.name].select(names).data.tobytes() == before.data.tobytes()


@pytest.mark.slow
@pytest.mark.parametrize("cell", [SETTINGS, OVER_RSI], ids=["egm", "rsi"], indirect=True)
def test_a_trial_goes_round_and_a_blind_tracker_lifts_the_tool_out_of_the_next(
    cell: SteppedCell, tmp_path: Path
) -> None:
    made = Laboratory(cell)
    air = made.run("free-0", made.first)
    assert np.abs(air.error[air.trial.path.milled] - air.error[air.trial.path.milled].mean(axis=0)).mean() < 300e-6
    assert np.abs(air.signals.force[air.trial.path.milled]).max() < 2.0
    assert 0.0 < tracker_late(air.trial, air.records) < 0.02
    refuse_another_replay(air)
    write_logs(tmp_path, air)
    logs = LogFolder(tmp_path, made.first, models().robot["motors"].axes)
    assert logs.signals(True, True).joints == pytest.approx(air.signals.joints, abs=2e-6)
    assert np.abs(logs.torques[1]).max() > 10.0
    done, reason, events = made.spoiled("blind", "see")
    assert "no block" in made.told[0]
    assert "a fresh block" in made.told[1]
    assert reason.startswith("the tracker is blind for 0.5")
    assert events == [f"retreat: {reason}"]
    until(lambda: height(cell) == pytest.approx(cell.config.pocket.clearance, abs=2e-4))
    refuse_another_replay(done)


@pytest.mark.slow
@pytest.mark.parametrize("cell", [SETTINGS, OVER_RSI], ids=["egm", "rsi"], indirect=True)
def test_free_space_and_a_pocket_are_learned(cell: SteppedCell) -> None:
    made = Laboratory(cell)
    learning = cell.config.learning.model_copy(update={"free": 1})
    learner = Learner(cell.config.model_copy(update={"learning": learning}), models())
    milled = made.run("milled-0", carried_out(learn_free_space(made.first, learner), made.run))
    made.bench.leave(nobody, never)
    assert height(cell) == pytest.approx(cell.config.robot.height, abs=1e-3)
    assert np.linalg.norm(learner.free[-1].mae) < 0.7 * np.linalg.norm(learner.free[0].mae)
    assert 2.0 < np.abs(milled.signals.force[milled.trial.path.milled]).mean(axis=0).max() < 100.0
    carried_out(learn_pocket(milled, learner, 1, 1), made.run)
    again = made.kept[-1]
    assert np.linalg.norm(again.mae) < 0.8 * np.linalg.norm(milled.mae)
    for each in made.kept:
        refuse_another_replay(each)


@pytest.mark.slow
def test_models_are_found_over_the_wires(tmp_path: Path) -> None:
    larger = {"feed": 0.02, "depth": 1e-3, "size": [30e-3, 30e-3], "workpiece": [40e-3, 40e-3, 3e-3]}
    settings = SETTINGS | {
        "pocket": SETTINGS["pocket"] | larger,
        "friction": {"poses": 12, "seconds": 2.0, "speed": 0.5},
        "learning": {"free": 1},
    }
    with SteppedCell(cell_cut, **settings) as cell:
        made = Laboratory(cell)
        with raw_run(tmp_path / "raw", cell.config) as folder:
            swept = sweep(cell.config, False, folder, lambda _: None, Conduct())
        found = calibrate(cell.config, "pocket", made.run, swept, {"rig": "cell"})
    assert min(found.models.robot["motors"].fresh) > 80.0
    assert min(found.models.robot["tool"].fresh) > 75.0
    late = found.free[-1].trial.late
    assert tracker_late(made.kept[0].trial, made.kept[0].records) == pytest.approx(late, abs=1e-3)
    assert (found.models.process["measured"].compliance_fresh[:2] > 50.0).all()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mishap", "reason", "remedy"),
    [
        ("force-saturate", "the force sensor is saturated: for 0.02", "force-recover"),
        (STOPPED, STOPPED, ""),
    ],
)
def test_whatever_else_goes_wrong_lifts_the_tool_out(cell: SteppedCell, mishap: str, reason: str, remedy: str) -> None:
    _, why, events = Laboratory(cell).spoiled(mishap, remedy)
    assert why.startswith(reason)
    assert events == [f"retreat: {why}"]
    until(lambda: height(cell) == pytest.approx(cell.config.pocket.clearance, abs=2e-4))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mishap", "reason"), [("mute", "the robot is silent for 1"), ("trip", "the robot's motors are off")]
)
def test_a_robot_at_fault_is_held_where_it_is(cell: SteppedCell, mishap: str, reason: str) -> None:
    done, why, events = Laboratory(cell).spoiled(mishap, "")
    assert why.startswith(reason)
    assert events == [f"robot_fault: {why}"]
    asked = done.records["trial"].select(["reference_2"]).data[-50:, 0]
    assert np.ptp(asked) < 1e-9
    assert height(cell) < 0.0
