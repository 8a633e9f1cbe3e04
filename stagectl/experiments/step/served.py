"""Steps and multisines for a person and for the daemon: `stagectl step`, and the procedure."""

from rigkit.experiment.by_options import ByOptions
from stagectl.daemon.cell_options import Run
from stagectl.experiments.midranging.pair_view import PairView
from stagectl.experiments.step.experiment import STEPS, Steps
from stagectl.experiments.step.report import tell
from stagectl.experiments.step.response import Wanted
from stagectl.robot.config import CellConfig

ASKED = {"asked_of_stage": "asked.fast_reference", "asked": "asked.slow_reference"}
STRIPS = (
    ("robot", ("asked", "slow"), "m"),
    ("stage", ("asked_of_stage", "fast"), "m"),
    ("control", ("control",), "m/s"),
)


class StepOptions(Run, Wanted):
    """A step or a multisine on robot, stage, or one after the other."""


_BOTH = ByOptions(
    STEPS,
    CellConfig,
    StepOptions,
    "midranging.session.live",
    Steps,
    lambda made: f"{made.wanted.kind}, {' and '.join(made.wanted.manipulators)}",
    lambda made: PairView(made, ASKED, STRIPS),
    tell,
)
procedure = _BOTH.procedure
step = _BOTH.command(
    """Identify delay, gain and bandwidth of robot and stage by a step or a multisine, for mid-ranging and dead times.

    Example: `stagectl step --config cell.toml --of both --kind multisine --out STEPS/`
    """
)
