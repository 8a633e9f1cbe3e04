"""Steps and multisines under the daemon."""

from rigkit.config_fault import checked
from rigkit.experiment.kept import create
from rigkit.experiment.procedure import ExperimentProcedure
from rigkit.service.paths import run_path
from rigkit.service.rig import Desk
from stagectl.experiments.midranging.pair_view import PairView
from stagectl.experiments.step.experiment import STEPS, Steps
from stagectl.experiments.step.options import StepOptions
from stagectl.experiments.step.response import Wanted
from stagectl.robot.config import CellConfig

ASKED = {"asked_of_stage": "asked.fast_reference", "asked": "asked.slow_reference"}
STRIPS = (
    ("robot", ("asked", "slow"), "m"),
    ("stage", ("asked_of_stage", "fast"), "m"),
    ("control", ("control",), "m/s"),
)


def procedure(config: CellConfig, options: StepOptions, desk: Desk) -> ExperimentProcedure:
    """Return a run of one axis.

    Parameters
    ----------
    config : CellConfig
    options : StepOptions
    desk : Desk

    Raises
    ------
    ValueError, OSError : a live one is to be paced, or what is asked cannot be; no folder is made.
    """
    options.refuse_live("midranging.session.live", config.midranging.session.live)
    given = {name: getattr(options, name) for name in Wanted.model_fields}
    made = Steps(config, checked(Wanted, given, "what is asked"))
    title = f"{options.kind}, {' and '.join(made.wanted.manipulators)}"
    view = PairView(made, ASKED, STRIPS)
    folder = create(run_path(config.daemon.data, options.run), STEPS, config, made)
    return ExperimentProcedure(STEPS, title, folder, made, view, desk, is_paced=options.paced)
