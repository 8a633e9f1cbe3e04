"""The procedures of the cell: what each is called, what may be said to it, and what makes it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from rigkit.config import Section
from rigkit.service.rig import Desk, Procedure
from stagectl.daemon.cell.options import JointsOptions, MillingOptions
from stagectl.experiments.feed.options import ForceOptions
from stagectl.experiments.midranging.options import MidrangeOptions
from stagectl.experiments.step.options import StepOptions
from stagectl.experiments.toroid.options import CellOptions
from stagectl.experiments.trials.options import IlcOptions


@dataclass(frozen=True)
class Entry:
    """A procedure of the cell.

    Parameters
    ----------
    name, title, kind, unit, on_pause, on_abort, options
        As of `rigkit.service.rig.Procedure`; one without `on_pause` cannot be paused.
    maker : str
        "module:Class", found when it begins, since calibration stands above this package: made from (config, options,
        desk), it is a `rig.UnderWay`.
    """

    name: str
    title: str
    kind: Literal["calibrate", "run"]
    unit: str
    on_pause: str
    on_abort: str
    options: type[Section]
    maker: str

    def told(self, run: Callable[[Desk, Any], None]) -> Procedure:
        """Return it as the daemon has it."""
        pausable = bool(self.on_pause)
        return Procedure(
            self.name, self.title, self.kind, self.unit, pausable, self.on_pause, self.on_abort, self.options, run
        )


HELD = "The robot is held where it is, within limits.stop, as by a STOP; what is recorded is kept. The rig stays armed."
PROCEDURES = (
    Entry(
        "ilc",
        "Learn to mill",
        "run",
        "s",
        "This trial is run to its end and kept; the tool is in the air until it goes on, with a fresh block.",
        "This trial is run to its end and kept; the run can be resumed. STOP lifts the tool out of the block at once.",
        IlcOptions,
        "stagectl.experiments.trials.daemon:procedure",
    ),
    Entry(
        "force",
        "Mill by force",
        "run",
        "cells",
        "This pocket is milled to its end; the next one waits until it goes on.",
        HELD,
        ForceOptions,
        "stagectl.experiments.feed.daemon:procedure",
    ),
    Entry(
        "cell",
        "Mill the toroid in steel",
        "run",
        "s",
        "This setup is run to its end; the next one waits until it goes on.",
        HELD,
        CellOptions,
        "stagectl.experiments.toroid.daemon:procedure",
    ),
    Entry(
        "midrange",
        "Share a position, macro and micro",
        "run",
        "s",
        "",
        "It ends at once; what is recorded is kept. Live, the robot is held and the stage goes to mid-travel.",
        MidrangeOptions,
        "stagectl.experiments.midranging.daemon:procedure",
    ),
    Entry(
        "step",
        "Step responses of robot and stage",
        "run",
        "s",
        "",
        "It ends at once; what is recorded is kept. Live, the robot is held and the stage goes to mid-travel.",
        StepOptions,
        "stagectl.experiments.step.daemon:procedure",
    ),
    Entry(
        "calibrate-milling",
        "Calibrate milling",
        "calibrate",
        "steps",
        "",
        "This trial is run to its end and kept, a sweep holds at once; begun again, it goes on from there.",
        MillingOptions,
        "calibration.milling.procedure:MillingProcedure",
    ),
    Entry(
        "calibrate-joints",
        "Calibrate joints in a clamp",
        "calibrate",
        "steps",
        "",
        "The arm holds where it is, soft servo and clamp stay; begun again, it measures the joints that are missing.",
        JointsOptions,
        "calibration.joint_clamping.procedure:JointsProcedure",
    ),
)
