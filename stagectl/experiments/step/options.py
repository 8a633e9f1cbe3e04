"""What steps may be begun with under the daemon."""

from stagectl.daemon.cell_options import Run
from stagectl.experiments.step.response import Wanted


class StepOptions(Run, Wanted):
    """A step or a multisine on robot, stage, or one after the other."""
