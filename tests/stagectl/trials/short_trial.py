"""A small pocket, milled in seconds of simulated time."""

from rigkit.config import load
from stagectl.robot.config import CellConfig
from stagectl.trials.conduct import Conduct, Milled
from stagectl.trials.recorded import RECORDED
from stagectl.trials.run import run
from stagectl.trials.surroundings import simulated
from stagectl.trials.trial import Trial, first_trial

SMALL = (
    "pocket.size=[14e-3, 14e-3]",
    "pocket.depth=5e-4",
    "pocket.clearance=3e-4",
    "pocket.lead=1.0",
    "pocket.tail=0.5",
    "pocket.workpiece=[20e-3, 20e-3, 2e-3]",
)


def small(*settings: str) -> Trial:
    return first_trial(load(None, CellConfig, [*SMALL, *settings]), "pocket")


def ran(trial: Trial) -> Milled:
    return run(trial, Conduct(), simulated, RECORDED, {})
