"""What mid-ranging may be begun with under the daemon."""

from typing import Literal

from rigkit.config import setting
from stagectl.daemon.cell_options import Run
from stagectl.experiments.midranging.scenario import SCENARIOS


class MidrangeOptions(Run):
    """The macro and the micro manipulator share one position."""

    scenario: str = setting("thesis-2", "", f"{', '.join(SCENARIOS)}, or a CSV or WAV file in the data folder")
    controller: Literal["aimc", "mvpc", "mvpc-aw", "vpc"] = setting("aimc", "", "who controls")
