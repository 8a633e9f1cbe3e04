"""A small pocket, milled in seconds of simulated time."""

from collections.abc import Mapping
from typing import NamedTuple

from ctlblocks.recording import Recording
from rigkit.config import load
from rigkit.experiment.runner import Conduct, remembered
from stagectl.experiments.trials.surroundings import simulated
from stagectl.experiments.trials.trial import Trial, first_trial
from stagectl.experiments.trials.trial_graph import TrialGraph
from stagectl.link.tell import nobody
from stagectl.robot.config import CellConfig

SMALL = (
    "pocket.size=[14e-3, 14e-3]",
    "pocket.depth=5e-4",
    "pocket.clearance=3e-4",
    "pocket.lead=1.0",
    "pocket.tail=0.5",
    "pocket.workpiece=[20e-3, 20e-3, 2e-3]",
)


class Ran(NamedTuple):
    """What came of a trial: recordings by what they are of, and why it ended early."""

    recordings: Mapping[str, Recording]
    reason: str


def small(*settings: str) -> Trial:
    return first_trial(load(None, CellConfig, [*SMALL, *settings]), "pocket")


def ran(trial: Trial, conduct: Conduct | None = None) -> Ran:
    records, ended = remembered(TrialGraph("one", trial, nobody, simulated).part(), conduct or Conduct())
    return Ran({track.removeprefix("one-"): record for track, record in records.items()}, ended.reason)
