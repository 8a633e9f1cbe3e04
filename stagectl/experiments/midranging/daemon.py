"""Mid-ranging under the daemon: a run of one controller."""

from rigkit.experiment.kept import create
from rigkit.experiment.procedure import ExperimentProcedure
from rigkit.service.paths import data_file, run_path
from rigkit.service.rig import Desk
from stagectl.experiments.midranging.experiment import Midranging
from stagectl.experiments.midranging.options import MidrangeOptions
from stagectl.experiments.midranging.pair_view import PairView
from stagectl.experiments.midranging.read_back import MIDRANGING
from stagectl.experiments.midranging.scenario import SCENARIOS, scenarios
from stagectl.robot.config import CellConfig

REFERENCE, ASKED = {"reference": "wanted.reference"}, {"asked": "controller.slow_reference"}
STRIPS = (
    ("position", ("reference", "position"), "m"),
    ("manipulators", ("slow", "fast"), "m"),
    ("control", ("control",), "m/s"),
)


def procedure(config: CellConfig, options: MidrangeOptions, desk: Desk) -> ExperimentProcedure:
    """Return a run of one controller.

    Parameters
    ----------
    config : CellConfig
    options : MidrangeOptions
    desk : Desk

    Raises
    ------
    ValueError, OSError : a live one is to be paced, there is no such scenario, or settings do not fit together; no
        folder is made.
    """
    options.refuse_live("midranging.session.live", config.midranging.session.live)
    data, name = config.daemon.data, options.scenario
    file = name if name in SCENARIOS else str(data_file(data, "scenario", name, SCENARIOS))
    made = Midranging(config, options.controller, scenarios(file, config.midranging.pair.rate))
    title = f"{options.controller}, {name}"
    view = PairView(made, REFERENCE | (ASKED if made.is_live else {}), STRIPS)
    folder = create(run_path(data, options.run), MIDRANGING, config, made)
    return ExperimentProcedure(MIDRANGING, title, folder, made, view, desk, is_paced=options.paced)
