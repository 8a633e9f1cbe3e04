"""A short run of the cell: a millimetre or two of the circle, for tests."""

from dataclasses import dataclass
from functools import cache

from ctlblocks.clock import Clock, Offline
from ctlblocks.recording import Recording
from rigkit import config as rig_file
from rigkit.experiment.runner import Conduct, remembered
from stagectl.config import StageConfig
from stagectl.experiments.toroid.experiment import Toroid, records_of
from stagectl.experiments.toroid.plan import PUSHED, Plan, loops_of, plan
from stagectl.robot.config import CellConfig
from stagectl.stage.state_feedback import StateFeedback

SHORT = ("toroid.lead=1.0", "toroid.turn=0.005", "toroid.ramp=0.1")
STAGE = rig_file.load(None, StageConfig, [*PUSHED, "outer.mistuning=0.0"])


@dataclass(frozen=True)
class Milled:
    """What came of a setup, by what is recorded: cell, tracker, surface, stage."""

    recordings: dict[str, Recording]
    reason: str


@cache
def loops() -> list[StateFeedback]:
    """Design the stage's loops, which takes longest."""
    return loops_of(STAGE)


def short(setup: str, *settings: str) -> Plan:
    cell = rig_file.load(None, CellConfig, [*SHORT, *settings])
    return plan(setup, cell, STAGE, loops() if setup.startswith("C") else ())


def milled(setup: str, *settings: str, clock: Clock | None = None) -> Milled:
    (part,) = Toroid([short(setup, *settings)]).parts()
    kept, ended = remembered(part, Conduct(clock=clock or Offline()))
    return Milled(records_of(setup, kept), ended.reason)
