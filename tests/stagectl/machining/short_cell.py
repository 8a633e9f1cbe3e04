"""A short run of the cell: a millimetre or two of the circle, for tests."""

from functools import cache

from rigkit import config as rig_file
from stagectl.config import StageConfig
from stagectl.machining.plan import PUSHED, Plan, designs_of, plan
from stagectl.machining.recorded import recordings
from stagectl.machining.run import Advance, Conduct, Milled, mill, offline
from stagectl.machining.surroundings import simulated
from stagectl.robot.config import CellConfig
from stagectl.stage.design import Design

SHORT = ("toroid.lead=1.0", "toroid.turn=0.005", "toroid.ramp=0.1")
STAGE = rig_file.load(None, StageConfig, [*PUSHED, "outer.mistuning=0.0"])


@cache
def designs() -> list[Design]:
    """Design the stage's loops, which takes longest."""
    return designs_of(STAGE)


def short(setup: str, *settings: str) -> Plan:
    cell = rig_file.load(None, CellConfig, [*SHORT, *settings])
    return plan(setup, cell, STAGE, designs() if setup.startswith("C") else ())


def milled(setup: str, *settings: str, advance: Advance = offline) -> Milled:
    made = short(setup, *settings)
    return mill(made, Conduct(advance=advance), simulated, recordings(made), {})
