"""Examples of the Blocks between the stage's lasers and its reference."""

import numpy as np

from firmware_sim.stage_cut import Cut
from firmware_sim.stage_lasers import Lasers
from firmware_sim.sticking_stage import StickingStage
from stagectl.config import Deflection
from stagectl.experiments.piezo.deflection import DeflectionReference
from stagectl.link.blocks import ReceiveAbsolute
from stagectl.link.config import Link
from stagectl.link.stage_link import StageLink
from stagectl.stage.laser_check import LaserCheck, LaserLimits
from stagectl.stage.laser_deflection import LaserDeflection
from tests.contract.conformance import Example

LIMITS = LaserLimits(5_000.0, 1e-3, 200, 1e9)
"""As fast as noise."""

LASER_EXAMPLES = {
    Cut: Example(lambda: Cut(start=0.0, seconds=5.0), Cut.begin),
    Lasers: Example(lambda: Lasers(2_500.0), rate=10_000.0),
    LaserCheck: Example(lambda: LaserCheck(LIMITS, 0.0, 1e3, 3), rate=10_000.0),
    LaserDeflection: Example(lambda: LaserDeflection(2_000.0, 0.01, 3), LaserDeflection.fade_in, 10_000.0),
    StickingStage: Example(StickingStage),
    DeflectionReference: Example(lambda: DeflectionReference(Deflection(), 3), rate=10_000.0),
    ReceiveAbsolute: Example(
        lambda: ReceiveAbsolute(StageLink(Link())),
        lambda block: block.link.signal("absolute")[0].put(np.zeros((5_000, 3))),
        10_000.0,
    ),
}
