"""The procedures of the cell: its experiments, and the calibrations, which stand above this package."""

from collections.abc import Callable
from typing import Any

from rigkit.code_name import resolve
from rigkit.experiment.registration import Served
from rigkit.service.rig import Desk, Procedure
from stagectl.experiments import registry

SERVED = {each.name: each.served for each in registry.CELL if each.served} | {
    "calibrate-milling": Served(
        "Calibrate milling",
        "steps",
        "This trial is finished and stored, a sweep holds at once; begun again, it continues from there.",
        "stagectl.daemon.cell.options:MillingOptions",
        "calibration.milling.procedure:MillingProcedure",
        kind="calibrate",
    ),
    "calibrate-joints": Served(
        "Calibrate joints in a clamp",
        "steps",
        "The arm holds where it is, soft servo and clamp stay; begun again, it measures the remaining joints.",
        "stagectl.daemon.cell.options:JointsOptions",
        "calibration.joint_clamping.procedure:JointsProcedure",
        kind="calibrate",
    ),
}


def procedures(runner: Callable[[str], Callable[[Desk, Any], None]]) -> tuple[Procedure, ...]:
    """Return them as the daemon has them; `runner` returns what runs what a maker makes."""
    return tuple(
        Procedure(
            name,
            each.title,
            each.kind,
            each.unit,
            bool(each.on_pause),
            each.on_pause,
            each.on_abort,
            resolve(each.options),
            runner(each.maker),
        )
        for name, each in SERVED.items()
    )
