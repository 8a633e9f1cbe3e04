"""`calibrate milling --live`: what must be there, and the ways that simulated trials do not have."""

from calibration.milling.session import chirp_path
from stagectl.experiments.trials.motions import ways
from stagectl.experiments.trials.trial import in_the_air
from stagectl.robot.config import CellConfig
from stagectl.robot.live.guide import refuse_unattended


def refuse_unfit(cell: CellConfig, is_sure: bool) -> None:
    """Refuse what cannot be calibrated live, before anything moves.

    Parameters
    ----------
    cell : CellConfig
    is_sure : bool
        Without asking before each motion.

    Raises
    ------
    ValueError : no ports of the robot's program and torques, or nobody at the terminal who is to confirm.
    """
    if not cell.robot.has_torques:
        raise ValueError("robot.signals is 0: friction shows in the motors' torques, must be the port of their line")
    refuse_unattended(cell, is_sure)


def live_steps(cell: CellConfig) -> list[str]:
    """Return in words how the tool comes to live trials and away from them."""
    before, after = ways(cell, in_the_air(cell, chirp_path(cell).path(cell.pocket)))
    return [before, f"{after}; a person takes the block away and puts it there, or the robot's program does"]
